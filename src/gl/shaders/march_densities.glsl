// Pre-classified cells. Along a ray densities are cubics, whose mean Simpson's rule gives exactly.

#include "densities.glsl"

// How far it came.
float march_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout vec4 sum, inout uint segments) {
  const float kThin = 0.05, kMostPieces = 64.0;  // optical depth of a piece, and how many there are at most
  Lattice l = lattice_of(ray, brick, plan);
  CellWalk walk = enter_lattice(ray, l, z, leave);
  while (walk.front < leave && !ends_pass(walk.front, z)) {
    DensityCorners c = fetch_densities(l, walk.cell);
    float back = back_of(walk), depth = back - walk.front;
    float largest = 0.0;
    for (int i = 0; i < 8; ++i) largest = max(largest, c.corner[i].x);
    float pieces = clamp(ceil(depth * ray.world_per_z * largest / kThin), 1.0, kMostPieces);
    if (!c.is_complete) pieces = 0.0;  // a cell with a corner that is missing is transparent
    float share = depth / max(pieces, 1.0);
    vec4 a = eval_densities(c, place_in_cell(ray, l, walk.cell, walk.front));
    for (float number = 0.0; number < pieces; number += 1.0) {
      vec4 b = eval_densities(c, place_in_cell(ray, l, walk.cell, walk.front + (number + 0.5) * share));
      vec4 end = eval_densities(c, place_in_cell(ray, l, walk.cell, walk.front + (number + 1.0) * share));
      composite_densities((a + 4.0 * b + end) / 6.0, share * ray.world_per_z, sum);
      a = end;
    }
    leave_cell(ray, l, back, walk);
    ++segments;
    work_done += 9u + uint(pieces);
  }
  return walk.front;
}

#include "whole_bricks.glsl"
