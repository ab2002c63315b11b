// What the passes of the source `slices` share: rays, and the part of each that lies in a slab (Engel and Ertl 2002).
//
// The position t of a place among the slices is affine along every ray, whether slices are planes or spheres round the
// eye: what a ray passes of a slab is found exactly for each pixel, and with it its length.

#include "frame.glsl"

layout(std140, binding = 2) uniform SliceBlock {
#include "slice_block.glsl"
} slices;

// A ray as it goes through the grid: places are base + z * step.
struct Path {
  vec3 base;       // camera frame
  vec3 direction;
  vec3 grid_base;  // grid coordinates
  vec3 grid_step;
  float t_base;
  float t_step;
  float z_near;
  float world_per_z;
};

Path make_path(vec3 base, vec3 direction, float z_near, float world_per_z) {
  Path path;
  path.base = base;
  path.direction = direction;
  path.grid_base = vec3(dot(slices.grid_x, vec4(base, 1.0)), dot(slices.grid_y, vec4(base, 1.0)),
                          dot(slices.grid_z, vec4(base, 1.0)));
  path.grid_step = vec3(dot(slices.grid_x.xyz, direction), dot(slices.grid_y.xyz, direction),
                          dot(slices.grid_z.xyz, direction));
  path.t_base = dot(slices.plane, vec4(base, 1.0));
  path.t_step = dot(slices.plane.xyz, direction);
  path.z_near = z_near;
  path.world_per_z = world_per_z;
  return path;
}

Path path_of_pixel(ivec2 pixel) {
  Ray ray = ray_of(pixel);
  Path path = make_path(vec3(ray.offset, 0.0), vec3(ray.slope, 1.0), frame.z_near, ray.world_per_z);
  if (slices.are_shells != 0) {
    path.t_step = ray.world_per_z / frame.world_per_local;
    path.t_base = -path.t_step * frame.eye_z;
  }
  return path;
}

vec3 place_at(Path path, float z) { return path.grid_base + z * path.grid_step; }

// A divisor that is not 0.
float apart(float x) {
  const float kLeast = 1e-20;
  return abs(x) < kLeast ? kLeast : x;
}

// The part of a path where base + z * slope lies between two values.
vec2 cut_span(vec2 span, float base, float slope, float low, float high) {
  float inverse = 1.0 / apart(slope);
  vec2 at = (vec2(low, high) - base) * inverse;
  return vec2(max(span.x, min(at.x, at.y)), min(span.y, max(at.x, at.y)));
}

vec2 span_in_box(Path path) {
  vec2 span = vec2(path.z_near, 1e30);
  for (int i = 0; i < 3; ++i)
    span = cut_span(span, path.grid_base[i], path.grid_step[i], slices.lower[i], slices.upper[i]);
  return span;
}

float t_of_slice(int slice) { return slices.t_first + float(slice) * slices.t_step; }

vec2 span_in_slab(Path path, int slab) {
  return cut_span(span_in_box(path), path.t_base, path.t_step, t_of_slice(slab), t_of_slice(slab + 1));
}

float z_of_slice(Path path, int slice) { return (t_of_slice(slice) - path.t_base) / apart(path.t_step); }
