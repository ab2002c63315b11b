// What passes that make tables of ray integrals have in common.

#include "segment.glsl"

layout(std140, binding = 8) uniform MakerBlock {
#include "tables/maker_block.glsl"
} maker;

// [node_count] extinction, colour at equal distances over the table's scalars
layout(binding = 12) uniform samplerBuffer function_nodes;

// A segment by places of its scalars in [0, 1] and its part of the longest length.
struct Slab {
  float front;
  float back;
  float share;
};

#ifdef ATLAS
// The inverse of the look-up: see src/optics/cylindrical_atlas.h.
Slab slab_of(ivec2 texel) {
  ivec2 tile = texel / maker.tile_size;
  vec2 place = vec2(texel - tile * maker.tile_size) / float(maker.tile_size - 1);
  int plane = min(tile.y * maker.column_count + tile.x, maker.plane_count - 1);
  float turn = -2.0 + 4.0 * float(plane) / float(maker.plane_count - 1), steepness = abs(turn);
  float slant = steepness <= 1.0 ? steepness * place.y : place.y;
  float low = place.x * (1.0 - slant);
  Slab slab;
  slab.share = steepness <= 1.0 ? place.y : (2.0 - steepness) * place.y;
  slab.front = turn >= 0.0 ? low : low + slant;
  slab.back = turn >= 0.0 ? low + slant : low;
  return slab;
}
#else
Slab slab_of(ivec2 texel) {
  vec2 place = vec2(texel) / float(maker.scalar_count - 1);
  return Slab(place.x, place.y, maker.share);
}
#endif

// As numbers of few bits hold it.
vec4 rounded(vec4 value) {
  float most = float(maker.most_number);
  return maker.most_number == 0 ? value : round(clamp(value, 0.0, 1.0) * most) / most;
}

float opacity_of(float depth) { return depth * absorbed_ratio(depth); }

float bound_of(float share) { return opacity_of(maker.most_extinction * share * maker.longest_length); }
