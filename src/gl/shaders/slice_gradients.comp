// Central differences of the values, stored scalars a cell; one-sided at the border and beside missing values, 0 where
// both neighbours are missing: as the CPU has them.

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(binding = 6) uniform sampler3D values;
layout(binding = 1) writeonly uniform image3D gradients;
layout(location = 0) uniform float texel_scale;

float difference_along(ivec3 at, ivec3 way) {
  ivec3 last = textureSize(values, 0) - 1;
  ivec3 before = max(at - way, ivec3(0)), after = min(at + way, last);
  float low = texelFetch(values, before, 0).x, here = texelFetch(values, at, 0).x, high = texelFetch(values, after, 0).x;
  int steps = (after.x - before.x) + (after.y - before.y) + (after.z - before.z);
  float slope = steps > 0 ? (high - low) / float(steps) : 0.0;
  if (isnan(slope)) slope = high - here;
  if (isnan(slope)) slope = here - low;
  return isnan(slope) ? 0.0 : slope * texel_scale;
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(at, textureSize(values, 0)))) return;
  vec4 gradient = vec4(difference_along(at, ivec3(1, 0, 0)), difference_along(at, ivec3(0, 1, 0)),
                       difference_along(at, ivec3(0, 0, 1)), 0.0);
  imageStore(gradients, at, gradient);
}
