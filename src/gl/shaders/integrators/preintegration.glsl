// Where segments lie in tables of ray integrals: the formulas of src/optics/segment_domain.h.

#include "segment.glsl"

layout(std140, binding = 7) uniform PreintegrationBlock {
#include "integrators/preintegration_block.glsl"
} domain;

float scalar_place(float stored) { return clamp((stored - domain.first_scalar) * domain.places_per_scalar, 0.0, 1.0); }

// Place in [0, 1] of a part of the longest length.
float length_place(float share) {
  const float kRange = 4095.0, kOctaves = 12.0;
  return domain.is_logarithmic != 0 ? log2(1.0 + kRange * share) / kOctaves : share;
}

// The opacity that a length would have at the largest extinction.
float opacity_bound(float world_length) {
  float depth = domain.largest_extinction * min(world_length, domain.longest);
  return depth * absorbed_ratio(depth);
}

// Texture coordinate of a place in [0, 1] among entries at the centres of texels.
float texel_place(float place, int count) { return (place * float(count - 1) + 0.5) / float(count); }

// Adds a segment given as premultiplied colour and opacity.
void composite(vec4 premultiplied, inout vec4 sum) {
  sum.rgb += sum.a * premultiplied.rgb;
  sum.a -= sum.a * premultiplied.a;
}
