// Takes each ray through the bricks of a grid front to back, some bricks a pass.

#include "marcher.glsl"
#include "march_pauses.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  GridRay ray = grid_ray_of(pixel);
  vec2 depths = clip_grid(ray);
  vec4 sum = kNothingYet;
  bool has_met = false, is_waiting = false;
  carried = Carried(vec4(0.0), -kNever, 0.0, depths.y);
  if (march.is_first_pass == 0) {
    depths.x = pauses[place].z;
    if (depths.x >= kNever) return;
    sum = pauses[place].sum;
    has_met = pauses[place].has_met != 0u;
    carried = Carried(pauses[place].sample_value, pauses[place].sample_depth, pauses[place].sample_number, depths.y);
  }
  BrickWalk walk;
  walk.z = walk.z_exit = 0.0;
  bool is_done = depths.x >= depths.y, is_inside = false;
  if (!is_done) walk = enter_grid(ray, depths.x, depths.y);
  Marcher marcher = no_brick_yet();
  int bricks_left = march.bricks_a_pass;
  while (!is_done && !is_waiting && bricks_left > 0 && work_done < uint(march.most_work)) {
    uvec4 plan = uvec4(kTransparent);
    float leave = 0.0;
    while (!is_done) {
      plan = plan_of(walk.brick);
      leave = leave_of(walk);
      if ((plan.x & 0xFFu) != kTransparent && leave > walk.z) break;
      leave_brick(ray, walk);
      is_done = has_left(walk);
    }
#ifdef HAS_NODES
    is_waiting = plan.w == 0u;
#endif
    is_inside = !is_done && !is_waiting;
    if (is_inside) {
      has_met = true;
      enter_brick(ray, walk.brick, plan, walk.z, leave, marcher);
    }
    bool is_inside_still = is_inside;
    while (is_inside_still) is_inside_still = take_step(ray, marcher, sum);
    if (is_inside) {
      float reached = reached_by(marcher);
      --bricks_left;
      if (reached < leave)
        walk.z = reached;  // the pass has ended: the brick is entered again, from there
      else
        leave_brick(ray, walk);
      is_done = has_left(walk) || is_over(sum);
    }
  }
  count_segments(place);
  if (is_done) {
    arrive(pixel, place, has_met, sum);
    return;
  }
  pauses[place].z = walk.z;
  pauses[place].sum = sum;
  pauses[place].has_met = uint(has_met);
  pauses[place].sample_value = carried.value;
  pauses[place].sample_depth = carried.depth;
  pauses[place].sample_number = carried.number;
  if (is_waiting)
    atomicAdd(counters.waiting_count, 1u);
  else
    atomicAdd(counters.unfinished_count, 1u);
}
