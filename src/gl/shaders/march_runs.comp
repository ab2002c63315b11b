// Takes each ray through a whole grid in equal steps, counted on from depth 0 of the camera's frame: those of
// src/cpu/kernels/packet_march-inl.h. Of each run of steps the ray asks once whether any brick on its way is seen.

#include "march.glsl"
#include "integrator.glsl"
#include "nodes.glsl"
#include "sampling.glsl"
#include "march_pauses.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kRun = 6.0;  // steps

// A ray, where it lies in the grid, and its steps: depth = number * share, cut to that.
struct Steps {
  GridRay ray;
  Lattice lattice;
  float z_enter, z_exit, share;
};

float depth_of(Steps steps, float number) { return clamp(number * steps.share, steps.z_enter, steps.z_exit); }

// Whether any brick is that a straight way may touch. It hardly ever reaches over more than two of an axis.
bool touches_seen(Steps steps, float from, float to) {
  vec3 a = steps.ray.origin + steps.ray.direction * depth_of(steps, from);
  vec3 b = steps.ray.origin + steps.ray.direction * depth_of(steps, to);
  ivec3 last = brick_count() - 1;
  ivec3 first = clamp(ivec3(min(a, b) * 0.125), ivec3(0), last), more = clamp(ivec3(max(a, b) * 0.125), ivec3(0), last) - first;
  int span = (more.x & 1) | (more.y & 1) << 1 | (more.z & 1) << 2;
  bool is_wide = (more.x | more.y | more.z) > 1;
  return is_wide || (plan_of(first).x >> (24 + span) & 1u) != 0u;
}

// A ray in a run of steps.
struct Runner {
  float number, end;  // of the step taken last, and of the last one of the run
  float depth;        // there
  Front front;
  float scalar_front;
};

// The next step; false where the run is over.
bool take_step(Steps steps, inout Runner r, inout vec4 sum) {
  ++work_done;
#ifndef TAKES_WHOLE_SEGMENTS
  if (!is_pending(r.front)) {
#endif
    r.number += 1.0;
    ++segment_count;
    float depth = depth_of(steps, r.number), back = sample_lattice(steps.lattice, depth);
    Segment segment = Segment(r.scalar_front, back, (depth - r.depth) * steps.ray.world_per_z);
    r.scalar_front = back;
    r.depth = depth;
#ifdef TAKES_WHOLE_SEGMENTS
  integrate(segment, r.front, sum);
  return r.number < r.end;
#else
    begin(segment, r.front);
  }
  advance(r.front, sum);
  return is_pending(r.front) || r.number < r.end;
#endif
}

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  Steps steps;
  steps.ray = grid_ray_of(pixel);
  steps.lattice = whole_lattice(steps.ray);
  vec2 depths = clip_grid(steps.ray);
  steps.z_enter = depths.x;
  steps.z_exit = depths.y;
  steps.share = march.sample_distance / steps.ray.world_per_z;
  vec4 sum = kNothingYet;
  bool has_met = false, is_done = depths.x >= depths.y;
  Runner runner;
  runner.number = floor(depths.x / steps.share);
  runner.end = runner.scalar_front = runner.depth = 0.0;
  runner.front = front_at(0.0);
  if (march.is_first_pass == 0) {
    if (pauses[place].z >= kNever) return;
    sum = pauses[place].sum;
    has_met = pauses[place].has_met != 0u;
    runner.number = pauses[place].sample_number;
  }
  float last = ceil(depths.y / steps.share);
  bool is_ready = false;  // whether the scalar and the front are those of the last step
  while (!is_done && work_done < uint(march.most_work)) {
    runner.end = min(runner.number + kRun, last);
    if (touches_seen(steps, runner.number, runner.end)) {
      has_met = true;
      runner.depth = depth_of(steps, runner.number);
      if (!is_ready) {
        runner.scalar_front = sample_lattice(steps.lattice, runner.depth);
        runner.front = front_at(runner.scalar_front);
      }
      is_ready = true;
      bool is_on = runner.number < runner.end;
      while (is_on) is_on = take_step(steps, runner, sum);
      is_done = is_over(sum);
    } else {
      ++work_done;
      is_ready = false;
      runner.number = runner.end;
    }
    is_done = is_done || runner.number >= last;
  }
  count_segments(place);
  if (is_done) {
    arrive(pixel, place, has_met, sum);
    return;
  }
  pauses[place].z = 0.0;
  pauses[place].sum = sum;
  pauses[place].has_met = uint(has_met);
  pauses[place].sample_number = runner.number;
  atomicAdd(counters.unfinished_count, 1u);
}
