// Segments of rays that go in equal steps wherever there is anything to be seen: a fixed rate, or a field that keeps to its
// chords all over.

#include "march.glsl"
#include "integrator.glsl"
#include "nodes.glsl"
#include "sampling.glsl"

// A ray in a brick.
struct Marcher {
  Lattice lattice;
  float z, share;       // where it came in, and the depth of a step
  float number, steps;  // of steps taken; all
  Front front;
  float scalar_front;
  float continues;  // depth that `front` is of
};

Marcher no_brick_yet() {
  Marcher m;
  m.z = m.share = m.number = m.steps = m.scalar_front = 0.0;
  m.continues = -kNever;
  m.front = front_at(0.0);
  return m;
}

void enter_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout Marcher m) {
  m.lattice = lattice_of(ray, brick, plan);
  m.z = z;
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
float reached_by(Marcher m) { return m.number < m.steps ? m.z + m.number * m.share : m.continues; }

// The next step; false where the brick, or the pass, is over.
bool take_step(GridRay ray, inout Marcher m, inout vec4 sum) {
  ++work_done;
#ifndef TAKES_WHOLE_SEGMENTS
  if (!is_pending(m.front)) {
#endif
    m.number += 1.0;
    uint count = uint(m.number > 0.0);
    segment_count += count;
    float back = sample_lattice(m.lattice, m.z + m.number * m.share);
    Segment segment = Segment(m.scalar_front, back, count > 0u ? m.share * ray.world_per_z : 0.0);
    m.scalar_front = back;
#ifdef TAKES_WHOLE_SEGMENTS
  integrate(segment, m.front, sum);
  return m.number < m.steps && !ends_pass(reached_by(m), m.z);
#else
    begin(segment, m.front);
  }
  advance(m.front, sum);
  return is_pending(m.front) || (m.number < m.steps && !ends_pass(reached_by(m), m.z));
#endif
}
