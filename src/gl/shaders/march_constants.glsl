// Segments of rays in cells that have one value each: exact with every integrator.

#include "march.glsl"
#include "integrator.glsl"
#include "nodes.glsl"

// How far it came.
float march_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout vec4 sum, inout uint segments) {
  Lattice l = lattice_of(ray, brick, plan);
  CellWalk walk = enter_lattice(ray, l, z, leave);
  Front front = front_at(0.0);
  while (walk.front < leave && !ends_pass(walk.front, z)) {
#ifdef IS_NEAREST
    float value = fetch_value(l.first + (walk.cell + 1) / 2);  // half a cell has the value of the point that it touches
#else
    float value = fetch_value(l.first + walk.cell);
#endif
    float back = back_of(walk);
    if (!is_missing(value)) integrate(Segment(value, value, (back - walk.front) * ray.world_per_z), front, sum);
    leave_cell(ray, l, back, walk);
    ++segments;
    ++work_done;
  }
  return walk.front;
}

#include "whole_bricks.glsl"
