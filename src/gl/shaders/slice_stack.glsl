// Values from a stack of 2D textures: of two neighbours, each bilinear, as much as a place lies between them
// (Rezk-Salama, Engel, Bauer, Greiner, Ertl 2000).
//
// STRIPES: which two is known; `layer` is the lower one.

#include "slice_corners.glsl"

layout(binding = 6) uniform sampler2DArray stack;

// In the stack's own axes: across its textures, then from one to the next.
vec3 in_stack(vec3 v) { return slices.stack_axis == 0 ? v.yzx : slices.stack_axis == 1 ? v.xzy : v; }

float value_at(vec3 place, int layer) {
  ivec3 at = nearest_value(in_stack(place + slices.value_shift), textureSize(stack, 0));
#ifdef STRIPES
  at.z = clamp(at.z, layer, min(layer + 1, textureSize(stack, 0).z - 1));
#endif
  return stored(texelFetch(stack, at, 0).x);
}

// Four values of one texture.
vec4 square_of(ivec3 corner, ivec3 size) {
  // In the middle of the four, where no rounding picks others.
  vec3 at = vec3((vec2(corner.xy) + 1.0) / vec2(size.xy), float(corner.z));
  return textureGather(stack, at).wzxy;
}

Corners corners_at(vec3 place, int layer) {
  Corners corners;
  ivec3 size = textureSize(stack, 0);
  vec3 at = in_stack(place + slices.value_shift);
  ivec3 a = lower_corner(at, size, corners.share);
#ifdef STRIPES
  a.z = layer;
  corners.share.z = clamp(at.z - float(layer), 0.0, 1.0);
#endif
  corners.low = stored(square_of(a, size));
  corners.high = stored(square_of(ivec3(a.xy, min(a.z + 1, size.z - 1)), size));
  return corners;
}
