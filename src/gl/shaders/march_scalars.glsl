// Segments of rays in trilinear cells: the source `march` (Grimm, Bruckner, Kanitsar, Groeller 2004). Where a brick's
// plan says that the field keeps to its chords, rays go in equal steps, or from cell to cell; otherwise the cubic in each
// cell is cut into as many linear pieces as its distance from the chord and the steepness of the function ask for.

#include "march.glsl"
#include "integrator.glsl"
#include "nodes.glsl"

float mix_corners(vec4 low, vec4 high, vec3 t) {
  vec4 square = mix(low, high, t.z);
  vec2 edge = mix(square.xy, square.zw, t.y);
  return mix(edge.x, edge.y, t.x);
}

// The field of an even lattice anywhere in it.
float sample_lattice(Lattice l, float z) {
  vec3 at = l.origin + l.direction * z;
  ivec3 cell = ivec3(clamp(at, vec3(0.0), vec3(l.size - 1)));
  vec4 low, high;
  fetch_corners(l, cell, low, high);
  return mix_corners(low, high, at - vec3(cell));
}

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

// Equal steps, each a segment.
void march_strides(GridRay ray, Lattice l, float stride, float z, float leave, inout vec4 sum, inout uint segments) {
  float depth = leave - z;
  float wanted = march.sample_distance > 0.0 ? depth * ray.world_per_z / march.sample_distance
                                             : depth * length(l.direction) / stride;
  float steps = clamp(ceil(wanted), 1.0, 1e5), share = depth / steps;
  Segment segment;
  segment.length = share * ray.world_per_z;
  segment.scalar_front = sample_lattice(l, z);
  Front front = front_at(segment.scalar_front);
  float number = 0.0;
  // Loops within loops: what only some segments need is off the way of all others, which matters to devices that execute
  // both sides of every branch.
  while (number < steps) {
    bool is_plain = true;
    while (is_plain && number < steps) {
      number += 1.0;
      segment.scalar_back = sample_lattice(l, z + number * share);
      is_plain = integrate_plainly(segment, front, sum);
      segment.scalar_front = is_plain ? segment.scalar_back : segment.scalar_front;
    }
    if (!is_plain) integrate(segment, front, sum);
    segment.scalar_front = segment.scalar_back;
  }
  segments += uint(steps);
}

// From cell to cell.
void march_cells(GridRay ray, Lattice l, uvec4 plan, float z, float leave, inout vec4 sum, inout uint segments) {
  float steepness = (plan.x & kIsCurved) != 0u ? uintBitsToFloat(plan.y) : 0.0;
  CellWalk walk = enter_lattice(ray, l, z, leave);
  Front front = front_at(0.0);
  Segment segment;
  vec4 cubic;
  float number = 1.0, pieces = 0.0, cell_back = 0.0;
  bool is_fresh = true;
  while (walk.front < leave || number < pieces) {
    bool is_plain = true;
    while (is_plain && (walk.front < leave || number < pieces)) {
      if (number >= pieces) {
        vec4 low, high;
        fetch_corners(l, walk.cell, low, high);
        float back = back_of(walk);
        cubic = make_cubic(low, high, place_in_cell(ray, l, walk.cell, walk.front),
                           place_in_cell(ray, l, walk.cell, back));
        float world = (back - walk.front) * ray.world_per_z;
        float all = (low.x + low.y + low.z + low.w) + (high.x + high.y + high.z + high.w);
        if (is_missing(all)) {
          // A cell with a corner that is missing is transparent; behind it the ray sets out anew.
          cubic = vec4(0.0);
          world = 0.0;
          is_fresh = true;
        } else if (is_fresh) {
          segment.scalar_front = cubic.x;
          front = front_at(cubic.x);
          is_fresh = false;
        }
        cell_back = cubic.x + cubic.y + cubic.z + cubic.w;
        pieces = count_pieces(cubic, steepness, sum.a, cell_back);
        number = 0.0;
        segment.length = world / pieces;
        leave_cell(ray, l, back, walk);
        ++segments;
      }
      number += 1.0;
      segment.scalar_back = number >= pieces ? cell_back : eval_cubic(cubic, number / pieces);
      is_plain = !(segment.length > 0.0) || integrate_plainly(segment, front, sum);
      segment.scalar_front = is_plain ? segment.scalar_back : segment.scalar_front;
    }
    if (!is_plain) integrate(segment, front, sum);
    segment.scalar_front = segment.scalar_back;
  }
}

void march_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout vec4 sum, inout uint segments) {
  Lattice l = lattice_of(ray, brick, plan);
  uint stride = plan.x >> 8 & 0xFFu;
  if (stride > 0u)
    march_strides(ray, l, float(stride), z, leave, sum, segments);
  else
    march_cells(ray, l, plan, z, leave, sum, segments);
}
