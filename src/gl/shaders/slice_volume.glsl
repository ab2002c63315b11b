// Values from a 3D texture.

#include "slice_corners.glsl"

layout(binding = 6) uniform sampler3D values;

float value_at(vec3 place, int layer) {
  return stored(texelFetch(values, nearest_value(place + slices.value_shift, textureSize(values, 0)), 0).x);
}

Corners corners_at(vec3 place, int layer) {
  Corners corners;
  ivec3 size = textureSize(values, 0);
  ivec3 a = lower_corner(place + slices.value_shift, size, corners.share), b = min(a + 1, size - 1);
  vec4 low = vec4(texelFetch(values, a, 0).x, texelFetch(values, ivec3(b.x, a.y, a.z), 0).x,
                  texelFetch(values, ivec3(a.x, b.y, a.z), 0).x, texelFetch(values, ivec3(b.x, b.y, a.z), 0).x);
  vec4 high = vec4(texelFetch(values, ivec3(a.x, a.y, b.z), 0).x, texelFetch(values, ivec3(b.x, a.y, b.z), 0).x,
                   texelFetch(values, ivec3(a.x, b.y, b.z), 0).x, texelFetch(values, b, 0).x);
  corners.low = stored(low);
  corners.high = stored(high);
  return corners;
}
