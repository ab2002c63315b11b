// Grids at a fixed rate: what lies between two samples of the scalar is up to the integrator.

#include "march.glsl"
#include "integrator.glsl"
#include "nodes.glsl"

struct Corners {
  vec4 low, high;
  bool is_complete;
};

Corners fetch_sampled(Lattice l, ivec3 cell) {
  Corners c;
  fetch_corners(l, cell, c.low, c.high);
  c.is_complete = !is_missing((c.low.x + c.low.y + c.low.z + c.low.w) + (c.high.x + c.high.y + c.high.z + c.high.w));
  return c;
}

// The second component: 1 where there is a value.
vec4 eval_sampled(Corners c, vec3 t) {
  vec4 square = mix(c.low, c.high, t.z);
  vec2 edge = mix(square.xy, square.zw, t.y);
  return c.is_complete ? vec4(mix(edge.x, edge.y, t.x), 1.0, 0.0, 0.0) : vec4(0.0);
}

void integrate_sampled(vec4 from, vec4 to, float world, inout vec4 sum) {
  if (from.y == 0.0 || to.y == 0.0) return;
  Front front = front_at(from.x);
  integrate(Segment(from.x, to.x, world), front, sum);
}

#include "samples.glsl"
