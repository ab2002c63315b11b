// One sample in the middle of the slab: the opacity is that of the slab's length along the ray.
//
// CONSTANT: of a field that is constant in each cell. DENSITIES: pre-classified, the function at the eight values around.

#include "segment.glsl"
#include "integrators/tables.glsl"
#include "integrators/control_points.glsl"

struct Sample {
  float z;
  float scalar;
};

// At the ends of the slab scalars matter to surfaces only.
Sample sample_at(Path path, float z, int layer) {
#ifdef SURFACES
  return Sample(z, interpolate(corners_at(place_at(path, z), layer)));
#else
  return Sample(z, 0.0);
#endif
}
Sample front_sample(Path path, float z, int layer) { return sample_at(path, z, layer); }
Sample back_sample(Path path, float z, int layer) { return sample_at(path, z, layer); }
Sample between(Sample front, Sample back, float share, float scalar) {
  return Sample(mix(front.z, back.z, share), scalar);
}
bool is_missing(Sample s) { return isnan(s.scalar); }

#ifdef DENSITIES
vec4 associated(float scalar) {
  vec4 optics = eval_optics(scalar);
  return vec4(optics.x, optics.x * optics.yzw);
}

vec4 mix_squares(vec4 scalars, vec2 share) {
  vec4 low = mix(associated(scalars.x), associated(scalars.y), share.x);
  vec4 high = mix(associated(scalars.z), associated(scalars.w), share.x);
  return mix(low, high, share.y);
}
#endif

void classify(Path path, Sample front, Sample back, int layer, inout vec4 sum) {
  float len = max(back.z - front.z, 0.0) * path.world_per_z;
  vec3 middle = place_at(path, 0.5 * (front.z + back.z));
#if defined(CONSTANT)
  float scalar = value_at(middle, layer);
  if (isnan(scalar)) return;
  composite_uniform(eval_optics(scalar), len, sum);
#elif defined(DENSITIES)
  Corners corners = corners_at(middle, layer);
  if (isnan(interpolate(corners))) return;
  vec4 densities = mix(mix_squares(corners.low, corners.share.xy), mix_squares(corners.high, corners.share.xy),
                       corners.share.z);
  composite_piece(densities.x * len, densities.yzw * len, sum);
#else
  float scalar = interpolate(corners_at(middle, layer));
  if (isnan(scalar)) return;
  composite_uniform(eval_optics(scalar), len, sum);
#endif
}
