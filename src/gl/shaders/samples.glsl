// Samples at equal depths along each ray, whatever cells lie between; `Corners`, `fetch_sampled`, `eval_sampled`,
// `is_valid` and `integrate_sampled` say of what.

// Where the first sample lies, and the number of the next one. A ray that enters the grid begins with a sample.
void begin_samples(float z, float distance_z, vec4 value) {
  carried.value = value;
  carried.depth = z;
  carried.number = floor(z / distance_z) + 1.0;
  if (carried.number * distance_z <= z) carried.number += 1.0;  // by rounding
}

// How far it came.
float march_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout vec4 sum, inout uint segments) {
  Lattice l = lattice_of(ray, brick, plan);
  CellWalk walk = enter_lattice(ray, l, z, leave);
  float distance_z = march.sample_distance / max(ray.world_per_z, 1e-30);
  while (walk.front < leave && !ends_pass(walk.front, z)) {
    Corners corners = fetch_sampled(l, walk.cell);
    float back = back_of(walk);
    if (carried.depth < -0.5 * kNever)
      begin_samples(z, distance_z, eval_sampled(corners, place_in_cell(ray, l, walk.cell, walk.front)));
    for (;;) {
      float depth = min(carried.number * distance_z, carried.z_exit);
      if (depth > back || depth <= carried.depth) break;
      if (ends_pass(carried.depth, z)) return walk.front;
      vec4 value = eval_sampled(corners, place_in_cell(ray, l, walk.cell, depth));
      integrate_sampled(carried.value, value, (depth - carried.depth) * ray.world_per_z, sum);
      carried.value = value;
      carried.depth = depth;
      carried.number += 1.0;
      ++segments;
      ++work_done;
    }
    leave_cell(ray, l, back, walk);
    ++work_done;
  }
  return walk.front;
}

#include "whole_bricks.glsl"
