// Differences of antiderivatives where the function is gentle at the table's resolution: scalars are rounded to nodes, so
// that a segment costs one fetch. A segment that begins and ends at one node takes the interval beside it.
//
// For functions that no segment needs to be cut for, and scalars within the table. IS_THIN: no segment has an optical
// depth of more than 0.25.

#include "segment.glsl"
#include "integrators/tables.glsl"

layout(binding = 4) uniform isamplerBuffer antiderivatives;  // [nodes][2]: T, K in fixed point; the rest is not needed

struct Front {
  float node;
  ivec4 sums;
};

float position_of(float scalar) {
  return clamp((scalar - tables.first) * tables.nodes_per_scalar, 0.0, float(tables.last_node));
}

Front front_at(float scalar) {
  float node = roundEven(position_of(scalar));
  return Front(node, texelFetch(antiderivatives, 2 * int(node)));
}

#define TAKES_WHOLE_SEGMENTS
void integrate(Segment segment, inout Front front, inout vec4 sum) {
  float at = position_of(segment.scalar_back), node = roundEven(at);
  bool is_flat = node == front.node;
  // From the last node there is none further.
  float to = is_flat ? node + (at >= node && node < float(tables.last_node) ? 1.0 : -1.0) : node;
  ivec4 sums = texelFetch(antiderivatives, 2 * int(to));
  vec4 integrals = vec4(sums - front.sums) * (tables.density_per_unit * segment.world_length / (to - front.node));
#ifdef IS_THIN
  float x = integrals.x, visible = sum.a * (1.0 + x * (-0.5 + x * (1.0 / 6.0 + x * (-1.0 / 24.0 + x * (1.0 / 120.0)))));
  sum.rgb += visible * integrals.yzw;
  sum.a -= visible * x;
#else
  composite_piece(integrals.x, integrals.yzw, sum);
#endif
  front.node = node;
  front.sums = is_flat ? front.sums : sums;
}
