// Segments of rays in trilinear cells: the source `march` (Grimm, Bruckner, Kanitsar, Groeller 2004). Where a brick's
// plan says that the field keeps to its chords, rays go in equal steps, or from cell to cell; otherwise the cubic in each
// cell is cut into as many linear pieces as its distance from the chord and the steepness of the function ask for.

#include "march.glsl"
#include "integrator.glsl"
#include "nodes.glsl"
#include "sampling.glsl"

// c.x + c.y u + c.z u^2 + c.w u^3: the scalar between two places in a cell.
vec4 make_cubic(vec4 low, vec4 high, vec3 at, vec3 to) {
  vec3 d = to - at;
  float xy_slope = at.x * d.y + at.y * d.x, xy_bend = d.x * d.y;
  vec4 rise = high - low;
  float b = low.y - low.x, c = low.z - low.x, e = (low.w - low.y) - c;
  vec3 lower = vec3(low.x + b * at.x + (e * at.x + c) * at.y, b * d.x + c * d.y + e * xy_slope, e * xy_bend);
  b = rise.y - rise.x, c = rise.z - rise.x, e = (rise.w - rise.y) - c;
  vec3 upper = vec3(rise.x + b * at.x + (e * at.x + c) * at.y, b * d.x + c * d.y + e * xy_slope, e * xy_bend);
  return vec4(lower.x + at.z * upper.x, lower.y + at.z * upper.y + d.z * upper.x,
              lower.z + at.z * upper.z + d.z * upper.y, d.z * upper.z);
}

float eval_cubic(vec4 c, float u) { return c.x + u * (c.y + u * (c.z + u * c.w)); }

// Bound on the distance from the chord: u (u - 1) (c2 + c3 (1 + u)).
float bend_of(vec4 c) { return 0.25 * max(abs(c.z + c.w), abs(c.z + 2.0 * c.w)); }

// Largest change of density with the scalar over a range.
float find_steepness(float low, float high) {
  const int kBins = 1024;
  ivec2 bin = ivec2(clamp((vec2(low, high) - march.steepness_first) * march.bins_per_scalar, 0.0, float(kBins - 1)));
  int level = findMSB(bin.y - bin.x + 1);
  return max(texelFetch(steepnesses, level * kBins + bin.x).x,
             texelFetch(steepnesses, level * kBins + bin.y - (1 << level) + 1).x);
}

// Into how many pieces a cell's segment is cut.
float count_pieces(vec4 cubic, float steepness, float transmittance, float scalar_back) {
  float bend = bend_of(cubic);
  if (transmittance * bend * steepness <= march.allowed_rate) return 1.0;
  float margin = 1.5 * bend;
  float most = find_steepness(min(cubic.x, scalar_back) - margin, max(cubic.x, scalar_back) + margin);
  return clamp(ceil(sqrt(transmittance * bend * most / march.allowed_rate)), 1.0, march.most_pieces);
}

// A ray in a brick.
struct Marcher {
  Lattice lattice;
  float steepness;  // bound on that of the function there
  float stride;     // depth of a step; 0: from cell to cell
  CellWalk walk;
  float begun;      // where it came in

  // The cell, or step, at hand, which it takes in linear pieces.
  vec4 cubic;
  float cell_front, pieces, number;

  Front front;
  float scalar_front;
  float continues;  // depth that `front` is of
};

Marcher no_brick_yet() {
  Marcher m;
  m.walk.front = m.walk.leave = m.begun = m.continues = -kNever;
  m.pieces = m.number = m.stride = m.steepness = m.cell_front = m.scalar_front = 0.0;
  m.cubic = vec4(0.0);
  m.front = front_at(0.0);
  return m;
}

void enter_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout Marcher m) {
  m.lattice = lattice_of(ray, brick, plan);
  m.steepness = (plan.x & kIsCurved) != 0u ? uintBitsToFloat(plan.y) : 0.0;
  m.walk = enter_lattice(ray, m.lattice, z, leave);
  m.begun = z;
  m.pieces = m.number = 0.0;
#ifdef HAS_NODES
  m.continues = -kNever;  // lattices side by side may differ at their border
#endif
#ifdef HAS_STRIDES
  float stride = float(plan.x >> 8 & 0xFFu);
  m.stride = stride > 0.0 ? (leave - z) / count_strides(ray, m.lattice, stride, leave - z) : 0.0;
#endif
}

// Where it has come to.
float reached_by(Marcher m) {
  return m.number < m.pieces ? mix(m.cell_front, m.walk.front, max(m.number, 0.0) / m.pieces) : m.walk.front;
}

// The next cell, or step. Where the ray sets out anew a piece without length comes before it.
void take_cell(GridRay ray, float transmittance, inout Marcher m) {
  bool is_fresh = m.continues != m.walk.front, is_stride = false;
  float plane = min(m.walk.next.x, min(m.walk.next.y, m.walk.next.z));
#ifdef HAS_STRIDES
  is_stride = m.stride > 0.0;
  if (is_stride) plane = m.walk.front + (is_fresh ? 0.0 : m.stride);
#endif
  float back = max(plane < m.walk.leave_soon ? plane : m.walk.leave, m.walk.front);
  ivec3 cell = m.walk.cell;
#ifdef HAS_STRIDES
  if (is_stride) cell = ivec3(clamp(m.lattice.origin + m.lattice.direction * back, vec3(0.0), vec3(m.lattice.size - 1)));
#endif
  vec4 low, high;
  fetch_corners(m.lattice, cell, low, high);
  vec3 to = place_in_cell(ray, m.lattice, cell, back);
  vec3 at = is_stride ? to : place_in_cell(ray, m.lattice, cell, m.walk.front);
  vec4 cubic = make_cubic(low, high, at, to);
  m.cell_front = m.walk.front;
  m.number = is_fresh && !is_stride ? -1.0 : 0.0;
  m.pieces = count_pieces(cubic, m.steepness, transmittance, cubic.x + cubic.y + cubic.z + cubic.w);
  m.continues = back;
  // A cell with a corner that is missing is transparent; behind it the ray sets out anew.
  bool is_gap = is_missing((low.x + low.y + low.z + low.w) + (high.x + high.y + high.z + high.w));
  if (is_gap) {
    cubic = vec4(0.0);
    m.number = -1.0;
    m.pieces = 0.0;
    m.continues = -kNever;
  }
  m.cubic = cubic;
  uint count = is_fresh && is_stride ? 0u : 1u;
  segment_count += count;
  work_done += count;
  leave_cell(ray, m.lattice, back, m.walk);
}

// The next piece; false where the brick, or the pass, is over.
bool take_step(GridRay ray, inout Marcher m, inout vec4 sum) {
  ++work_done;
#ifndef TAKES_WHOLE_SEGMENTS
  if (!is_pending(m.front)) {
#endif
    if (m.number >= m.pieces) take_cell(ray, sum.a, m);
    m.number += 1.0;
    float back = m.number < m.pieces ? eval_cubic(m.cubic, m.number / m.pieces)
                                     : m.cubic.x + m.cubic.y + m.cubic.z + m.cubic.w;
    float depth = m.number > 0.0 ? (m.walk.front - m.cell_front) / m.pieces : 0.0;
    Segment segment = Segment(m.scalar_front, m.number > 0.0 ? back : m.cubic.x, depth * ray.world_per_z);
    m.scalar_front = segment.scalar_back;
#ifdef TAKES_WHOLE_SEGMENTS
  integrate(segment, m.front, sum);
  return (m.number < m.pieces || m.walk.front < m.walk.leave) && !ends_pass(reached_by(m), m.begun);
#else
    begin(segment, m.front);
  }
  advance(m.front, sum);
  return is_pending(m.front) ||
         ((m.number < m.pieces || m.walk.front < m.walk.leave) && !ends_pass(reached_by(m), m.begun));
#endif
}
