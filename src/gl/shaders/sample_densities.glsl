// Pre-classified grids at a fixed rate.

#include "densities.glsl"

#define Corners DensityCorners

Corners fetch_sampled(Lattice l, ivec3 cell) { return fetch_densities(l, cell); }

vec4 eval_sampled(Corners c, vec3 t) { return c.is_complete ? eval_densities(c, t) : vec4(0.0); }

void integrate_sampled(vec4 from, vec4 to, float world, inout vec4 sum) { composite_densities(to, world, sum); }

#include "samples.glsl"
