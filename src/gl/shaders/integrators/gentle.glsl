// Differences of antiderivatives where the function is gentle at the table's resolution: scalars are rounded to nodes, so
// that a piece costs one fetch of them. One that begins and ends at the same node takes the interval beside it.
//
// For scalars within the table. IS_WHOLE: no segment needs to be cut. IS_THIN: none has an optical depth of more than
// 0.25.

#include "segment.glsl"
#include "integrators/tables.glsl"

layout(binding = 4) uniform isamplerBuffer antiderivatives;  // [nodes][2]: T, K in fixed point; the rest is not needed
#ifndef IS_WHOLE
layout(binding = 5) uniform samplerBuffer color_variation;  // [nodes] up to the node
#endif

struct Front {
  float node;
  ivec4 sums;
#ifndef IS_WHOLE
  float position;  // in nodes
  float variation;
  float position_back;
  float left;   // world length
  float share;  // of what is left, for the next piece
  bool is_pending;
#endif
};

float position_of(float scalar) {
  return clamp((scalar - tables.first) * tables.nodes_per_scalar, 0.0, float(tables.last_node));
}

Front front_at(float scalar) {
  Front front;
  float at = position_of(scalar);
  front.node = roundEven(at);
  front.sums = texelFetch(antiderivatives, 2 * int(front.node));
#ifndef IS_WHOLE
  front.position = front.position_back = at;
  front.variation = texelFetch(color_variation, int(front.node)).x;
  front.left = 0.0;
  front.share = 1.0;
  front.is_pending = false;
#endif
  return front;
}

// Optical depth and emission on the way to a place; `sums`: there.
vec4 integrate_to(float at, float len, Front front, out float node, out ivec4 sums) {
  node = roundEven(at);
  bool is_flat = node == front.node;
  // From the last node there is none further.
  float to = is_flat ? node + (at >= node && node < float(tables.last_node) ? 1.0 : -1.0) : node;
  ivec4 ends = texelFetch(antiderivatives, 2 * int(to));
  sums = is_flat ? front.sums : ends;
  return vec4(ends - front.sums) * (tables.density_per_unit * len / (to - front.node));
}

void composite_integrals(vec4 integrals, inout vec4 sum) {
#ifdef IS_THIN
  float x = integrals.x, visible = sum.a * (1.0 + x * (-0.5 + x * (1.0 / 6.0 + x * (-1.0 / 24.0 + x * (1.0 / 120.0)))));
  sum.rgb += visible * integrals.yzw;
  sum.a -= visible * x;
#else
  composite_piece(integrals.x, integrals.yzw, sum);
#endif
}

#ifdef IS_WHOLE
#define TAKES_WHOLE_SEGMENTS
void integrate(Segment segment, inout Front front, inout vec4 sum) {
  float node;
  ivec4 sums;
  vec4 integrals = integrate_to(position_of(segment.scalar_back), segment.world_length, front, node, sums);
  composite_integrals(integrals, sum);
  front = Front(node, sums);
}
#else
void begin(Segment segment, inout Front front) {
  front.position_back = position_of(segment.scalar_back);
  front.left = segment.world_length;
  front.share = 1.0;
  front.is_pending = true;
}

bool is_pending(Front front) { return front.is_pending; }

// One piece: as long as the tolerance allows, see antiderivative.glsl.
void advance(inout Front front, inout vec4 sum) {
  bool is_last = front.share >= 1.0;
  float at = is_last ? front.position_back : mix(front.position, front.position_back, front.share), node;
  float len = front.left * (is_last ? 1.0 : front.share);
  ivec4 sums;
  vec4 integrals = integrate_to(at, len, front, node, sums);
  float variation = texelFetch(color_variation, int(node)).x;
  float error = integrals.x * integrals.x * min(1.0, abs(variation - front.variation)) * sum.a;
  if (error > tables.split_threshold && abs(node - front.node) > 1.001) {
    front.share *= 0.5;
    front.is_pending = true;
    return;
  }
  composite_integrals(integrals, sum);
  front.node = node;
  front.sums = sums;
  front.position = at;
  front.variation = variation;
  front.left -= len;
  front.share = min(2.0 * front.share / max(1.0 - front.share, 1e-3), 1.0);
  front.is_pending = !is_last;
}

#include "integrators/integrate.glsl"
#endif
