// Segments of rays that go in equal steps wherever there is anything to be seen: a fixed rate, or a field that keeps to its
// chords all over.

#include "march.glsl"
#include "integrator.glsl"
#include "nodes.glsl"
#include "sampling.glsl"

// A ray in a brick. Where steps are counted on through the whole grid, they have numbers of their own: those that reach
// into the brick are taken, and lie where they lie, in this brick or another one.
struct Marcher {
  Lattice lattice;
  float z, share;              // where step 1 begins, and the depth of a step
  float begun;                 // where the first step in the brick, or in the pass, begins
  float first, number, steps;  // steps before the brick; taken so far; in the end
  Front front;
  float scalar_front;
  float continues;  // depth that `front` is of, or number
};

Marcher no_brick_yet() {
  Marcher m;
  m.z = m.share = m.begun = m.first = m.number = m.steps = m.scalar_front = 0.0;
  m.continues = -kNever;
  m.front = front_at(0.0);
  return m;
}

// Depth of the end of a step.
float depth_of(Marcher m, float number) {
  float depth = m.z + number * m.share;
  return march.counts_steps != 0 ? clamp(depth, carried.z_enter, carried.z_exit) : depth;
}

// How far the depth of a step may be off, in steps.
const float kSlack = 1e-3;

void enter_counted(GridRay ray, float z, float leave, inout Marcher m) {
  m.lattice = whole_lattice(ray);
  m.z = 0.0;
  m.share = march.sample_distance / ray.world_per_z;
  m.first = max(floor(z / m.share + kSlack), carried.number);
  m.steps = max(ceil(leave / m.share), m.first + 1.0);
  m.number = m.continues != m.first ? m.first - 1.0 : m.first;
  m.begun = depth_of(m, m.first);
}

void enter_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout Marcher m) {
  if (march.counts_steps != 0) {
    enter_counted(ray, z, leave, m);
    return;
  }
  m.first = 0.0;
  m.lattice = lattice_of(ray, brick, plan);
  m.z = m.begun = z;
  m.steps = count_strides(ray, m.lattice, float(plan.x >> 8 & 0xFFu), leave - z);
  m.share = (leave - z) / m.steps;
#ifdef HAS_NODES
  bool is_fresh = true;  // lattices side by side may differ at their border
#else
  bool is_fresh = m.continues != z;
#endif
  m.number = is_fresh ? -1.0 : 0.0;  // a step without length comes first
  m.continues = leave;
}

// Where it has come to.
float reached_by(Marcher m) {
  bool is_through = m.number >= m.steps;
  if (march.counts_steps != 0) return is_through ? kNever : depth_of(m, m.number);
  return is_through ? m.continues : m.z + m.number * m.share;
}

// The next step; false where the brick, or the pass, is over.
bool take_step(GridRay ray, inout Marcher m, inout vec4 sum) {
  ++work_done;
#ifndef TAKES_WHOLE_SEGMENTS
  if (!is_pending(m.front)) {
#endif
    m.number += 1.0;
    bool counts = m.number > m.first;
    segment_count += uint(counts);
    float z = depth_of(m, m.number), back = sample_lattice(m.lattice, z);
    float depth = march.counts_steps != 0 ? z - depth_of(m, m.number - 1.0) : m.share;
    Segment segment = Segment(m.scalar_front, back, counts ? depth * ray.world_per_z : 0.0);
    m.scalar_front = back;
    if (march.counts_steps != 0) carried.number = m.continues = m.number;
#ifdef TAKES_WHOLE_SEGMENTS
  integrate(segment, m.front, sum);
  return m.number < m.steps && !ends_pass(reached_by(m), m.begun);
#else
    begin(segment, m.front);
  }
  advance(m.front, sum);
  return is_pending(m.front) || (m.number < m.steps && !ends_pass(reached_by(m), m.begun));
#endif
}
