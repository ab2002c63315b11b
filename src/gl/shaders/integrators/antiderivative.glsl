// Differences of antiderivatives (Max, Hanrahan, Crawfis 1990; Lum, Wilson, Ma 2004), split where the error estimate
// asks: the formulas of src/cpu/kernels/antiderivative-inl.h, for one ray.

#include "segment.glsl"
#include "integrators/tables.glsl"
#include "integrators/control_points.glsl"

// [nodes][2]: T, K in fixed point; the bits of rho, rho * colour.
layout(binding = 4) uniform isamplerBuffer antiderivatives;
// [nodes + 1]: colour variation up to the node (its bits), whether the interval behind is coarse, how many before are.
layout(binding = 5) uniform isamplerBuffer node_marks;

struct Front {
  float position;  // in nodes
  ivec4 sums;
  vec4 densities;
};

float position_of(float scalar) { return (scalar - tables.first) * tables.nodes_per_scalar; }
float inside(float at) { return clamp(at, 0.0, float(tables.last_node)); }
bool is_outside(float at) { return at < -0.5 || at > float(tables.last_node) + 0.5; }

Front point_at(float at) {
  float clamped = inside(at);
  int node = min(int(clamped), tables.last_node - 1);
  float f = clamped - float(node);
  ivec4 sums = texelFetch(antiderivatives, 2 * node);
  vec4 low = intBitsToFloat(texelFetch(antiderivatives, 2 * node + 1));
  vec4 slope = intBitsToFloat(texelFetch(antiderivatives, 2 * node + 3)) - low;
  vec4 mean = low + 0.5 * f * slope;
  return Front(at, sums + ivec4(roundEven(f * tables.units_per_density * mean)), low + f * slope);
}

Front front_at(float scalar) { return point_at(position_of(scalar)); }

// Optical depth and emission between two points inside the table.
vec4 integrate_between(Front a, Front b, float len) {
  float nodes = b.position - a.position;
  if (abs(nodes) < 1.0) return (a.densities + b.densities) * (0.5 * len);
  return vec4(b.sums - a.sums) * (len * tables.density_per_unit / nodes);
}

vec4 density_anywhere(Front p) {
  if (p.position < 0.0) return tables.density_below;
  return p.position > float(tables.last_node) ? tables.density_above : p.densities;
}

// The same where a point may lie beyond the table's ends: there the function is constant.
vec4 integrate_anywhere(Front a, Front b, float len) {
  float nodes = b.position - a.position, last = float(tables.last_node);
  if (abs(nodes) < 1.0) return (density_anywhere(a) + density_anywhere(b)) * (0.5 * len);
  float below = min(b.position, 0.0) - min(a.position, 0.0);
  float above = max(b.position - last, 0.0) - max(a.position - last, 0.0);
  vec4 total = vec4(b.sums - a.sums) * tables.density_per_unit + tables.density_below * below +
               tables.density_above * above;
  return total * (len / nodes);
}

int node_at(float at) { return int(inside(at)); }
float variation_at(float at) { return intBitsToFloat(texelFetch(node_marks, node_at(at + 0.5)).x); }
bool is_coarse(float at) { return texelFetch(node_marks, node_at(at)).y != 0; }
bool passes_coarse(float a, float b) {
  return texelFetch(node_marks, node_at(min(a, b))).z != texelFetch(node_marks, node_at(max(a, b)) + 1).z;
}

// In pieces, each as long as the tolerance allows: one that errs by more is halved, one that passes is followed by one
// twice as long.
void integrate_pieces(float len, Front front, Front back, inout vec4 sum) {
  float span = back.position - front.position;
  float shortest = 1.0 / max(abs(span), 1.0);  // one node: the colour is nearly linear there
  Front at = front;
  float variation = variation_at(front.position), t = 0.0, step_size = 1.0;
  for (;;) {
    bool is_last = t + step_size >= 1.0;
    float next_t = is_last ? 1.0 : t + step_size;
    Front next = point_at(is_last ? back.position : front.position + span * next_t);
    float next_variation = variation_at(next.position);
    vec4 integrals = integrate_anywhere(at, next, len * (next_t - t));
    float error = integrals.x * integrals.x * min(1.0, abs(next_variation - variation)) * sum.a;
    bool is_fine = error <= tables.split_threshold || step_size <= shortest;
    step_size *= is_fine ? 2.0 : 0.5;
    if (!is_fine) continue;
    composite_piece(integrals.x, integrals.yzw, sum);
    if (is_last || sum.a <= kDark) return;
    at = next;
    variation = next_variation;
    t = next_t;
  }
}

// From control point to control point, in pieces so thin that self-attenuation is within the tolerance.
void integrate_exactly(Segment segment, inout vec4 sum) {
  LinearWalk walk = begin_linear_walk(segment);
  while (!walk.is_done && sum.a > kDark) {
    float goal_t, goal;
    bool is_end;
    find_goal(segment, walk, goal_t, goal, is_end);
    vec3 change = abs(eval_interval(walk.interval, walk.scalar).yzw - eval_interval(walk.interval, goal).yzw);
    float most = max(max(change.x, max(change.y, change.z)), 1e-6);
    LinearPiece p = next_piece(segment, sqrt(tables.split_threshold / most), walk);
    float depth = 0.5 * (p.front.x + p.back.x) * p.length;
    vec3 emission = (p.front.x * (2.0 * p.front.yzw + p.back.yzw) + p.back.x * (2.0 * p.back.yzw + p.front.yzw)) *
                    (p.length / 6.0);
    composite_piece(depth, emission, sum);
  }
}

void integrate(Segment segment, inout Front front, inout vec4 sum) {
  Front before = front;
  Front back = front_at(segment.scalar_back);
  front = back;
  vec4 integrals = integrate_between(before, back, segment.length);
  float nodes = abs(back.position - before.position);
  bool beyond = tables.covers_data == 0 && (is_outside(before.position) || is_outside(back.position));
  bool coarse = tables.has_coarse != 0 && (is_coarse(before.position) || is_coarse(back.position));
  float weight = integrals.x * integrals.x * sum.a;
  bool is_doubtful = beyond || integrals.x > 0.25 ||
                     weight * min(1.0, nodes * tables.largest_color_slope) > tables.split_threshold;
  if (is_doubtful && !coarse) {
    // By the colours that the segment really passes.
    float change = min(1.0, abs(variation_at(back.position) - variation_at(before.position)));
    is_doubtful = beyond || weight * change > tables.split_threshold;
    coarse = is_doubtful && tables.has_coarse != 0 && passes_coarse(before.position, back.position);
  }
  if (coarse)
    integrate_exactly(segment, sum);
  else if (is_doubtful)
    integrate_pieces(segment.length, before, back, sum);
  else
    composite_piece(integrals.x, integrals.yzw, sum);
}
