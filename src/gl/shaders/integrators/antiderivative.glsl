// Differences of antiderivatives (Max, Hanrahan, Crawfis 1990; Lum, Wilson, Ma 2004), split where the error estimate
// asks: the formulas of src/cpu/kernels/antiderivative-inl.h, piece by piece.
//
// HAS_COARSE: the table is too coarse in places, which are left to the control points. BEYOND: scalars may lie beyond
// the table's ends.

#include "segment.glsl"
#include "integrators/tables.glsl"

#ifdef HAS_COARSE
#include "integrators/control_points.glsl"
#endif

// [nodes][2]: T, K in fixed point; the bits of rho, rho * colour.
layout(binding = 4) uniform isamplerBuffer antiderivatives;
layout(binding = 5) uniform samplerBuffer color_variation;  // [nodes] up to the node
#ifdef HAS_COARSE
// [nodes]: twice how many intervals before are too coarse, and one more where that behind is.
layout(binding = 11) uniform isamplerBuffer node_marks;
#endif

// The function where a ray is, and what is left of its segment.
struct Front {
  float position;  // in nodes
  ivec4 sums;
  vec4 densities;
  float variation;  // of the colour, up to there
  float position_back;
  float left;    // world length
  float share;   // of what is left, for the next piece
  bool is_pending;
#ifdef HAS_COARSE
  int mark;       // of its node
  Course course;  // the same segment from control point to control point,
  bool is_exact;  // where it is taken so
#endif
};

float position_of(float scalar) { return (scalar - tables.first) * tables.nodes_per_scalar; }
float inside(float at) { return clamp(at, 0.0, float(tables.last_node)); }
int node_at(float at) { return int(inside(at)); }
float variation_at(float at) { return texelFetch(color_variation, node_at(at + 0.5)).x; }

// Puts the ray at a position.
void place(float at, inout Front front) {
  float clamped = inside(at);
  int node = min(int(clamped), tables.last_node - 1);
  float f = clamped - float(node);
  ivec4 sums = texelFetch(antiderivatives, 2 * node);
  vec4 low = intBitsToFloat(texelFetch(antiderivatives, 2 * node + 1));
  vec4 slope = intBitsToFloat(texelFetch(antiderivatives, 2 * node + 3)) - low;
  vec4 mean = low + 0.5 * f * slope;
  front.position = at;
  front.sums = sums + ivec4(roundEven(f * tables.units_per_density * mean));
  front.densities = low + f * slope;
  front.variation = variation_at(at);
#ifdef HAS_COARSE
  front.mark = texelFetch(node_marks, node_at(at)).x;
#endif
}

Front front_at(float scalar) {
  Front front;
  place(position_of(scalar), front);
  front.position_back = front.position;
  front.left = 0.0;
  front.share = 1.0;
  front.is_pending = false;
#ifdef HAS_COARSE
  front.course = Course(Segment(scalar, scalar, 0.0), 1.0, scalar, 0, false);
  front.is_exact = false;
#endif
  return front;
}

#ifdef BEYOND
vec4 density_anywhere(Front p) {
  if (p.position < 0.0) return tables.density_below;
  return p.position > float(tables.last_node) ? tables.density_above : p.densities;
}
#else
vec4 density_anywhere(Front p) { return p.densities; }
#endif

// Optical depth and emission between two places; beyond the table's ends the function is constant.
vec4 integrate_between(Front a, Front b, float len) {
  float nodes = b.position - a.position;
  bool is_flat = abs(nodes) < 1.0;
  vec4 total = vec4(b.sums - a.sums) * tables.density_per_unit;
#ifdef BEYOND
  float last = float(tables.last_node);
  float below = min(b.position, 0.0) - min(a.position, 0.0);
  float above = max(b.position - last, 0.0) - max(a.position - last, 0.0);
  total += tables.density_below * below + tables.density_above * above;
#endif
  vec4 mean = (density_anywhere(a) + density_anywhere(b)) * 0.5;
  return is_flat ? mean * len : total * (len / (is_flat ? 1.0 : nodes));
}

#ifdef HAS_COARSE
bool is_coarse(int mark) { return (mark & 1) != 0; }
// Whether an interval from the node of one mark to that behind the node of the other is too coarse.
bool passes_coarse(int a, int b) { return (min(a, b) >> 1) != ((max(a, b) + 1) >> 1); }
#endif

void begin(Segment segment, inout Front front) {
  front.position_back = position_of(segment.scalar_back);
  front.left = segment.world_length;
  front.share = 1.0;
  front.is_pending = true;
#ifdef HAS_COARSE
  front.is_exact = segment.world_length > 0.0 && is_coarse(front.mark);
  front.course = begin_course(segment);
#endif
}

bool is_pending(Front front) { return front.is_pending; }

#ifdef HAS_COARSE
// One piece between control points, so thin that self-attenuation is within the tolerance.
void advance_exactly(inout Front front, inout vec4 sum) {
  LinearPiece p;
  float goal_t, goal;
  if (!find_piece(front.course, p, goal_t, goal)) return;
  vec3 change = abs(p.front.yzw - p.back.yzw);
  float most = max(max(change.x, max(change.y, change.z)), 1e-6);
  const float kDark = 1e-6;  // what comes after that little light has no colour to add
  float deepest = sum.a > kDark ? sqrt(tables.split_threshold / most) : 1e30;
  pass_piece(deepest, goal_t, goal, p, front.course);
  float depth = 0.5 * (p.front.x + p.back.x) * p.world_length;
  vec3 emission = (p.front.x * (2.0 * p.front.yzw + p.back.yzw) + p.back.x * (2.0 * p.back.yzw + p.front.yzw)) *
                  (p.world_length / 6.0);
  composite_piece(depth, emission, sum);
}
#endif

// One piece: as long as the tolerance allows. One that would err by more is halved, one that passes is followed by one
// twice as long.
void advance(inout Front front, inout vec4 sum) {
  bool is_last = front.share >= 1.0;
#ifdef HAS_COARSE
  if (front.is_exact) {
    advance_exactly(front, sum);
    if (front.course.is_pending) return;
    is_last = true;
  }
#endif
  Front next = front;
  place(is_last ? front.position_back : mix(front.position, front.position_back, front.share), next);
  float len = front.left * (is_last ? 1.0 : front.share);
  vec4 integrals = integrate_between(front, next, len);
  // What the spread of colour errs: dc tau^2 / 12 (see the kernel). Within a node the colour is nearly linear.
  float error = integrals.x * integrals.x * min(1.0, abs(next.variation - front.variation)) * sum.a;
  bool is_fine = error <= tables.split_threshold || abs(next.position - front.position) <= 1.001;
#ifdef HAS_COARSE
  if (front.is_exact) {
    integrals = vec4(0.0);  // they have been composited
    is_fine = true;
  } else if (len > 0.0 && (is_coarse(next.mark) || (!is_fine && passes_coarse(front.mark, next.mark)))) {
    front.is_exact = true;  // only at first: what follows a piece that passed never is
    return;
  }
#endif
  if (!is_fine) {
    front.share *= 0.5;
    return;
  }
  composite_piece(integrals.x, integrals.yzw, sum);
  front.position = next.position;
  front.sums = next.sums;
  front.densities = next.densities;
  front.variation = next.variation;
#ifdef HAS_COARSE
  front.mark = next.mark;
#endif
  front.left -= len;
  // Of what is left, twice as long as this piece was.
  front.share = min(2.0 * front.share / max(1.0 - front.share, 1e-3), 1.0);
  front.is_pending = !is_last;
}

#include "integrators/integrate.glsl"
