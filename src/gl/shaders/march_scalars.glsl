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

// Equal steps, each a segment; how far they came.
float march_strides(GridRay ray, Lattice l, float stride, float z, float leave, inout vec4 sum, inout uint segments) {
  float depth = leave - z;
  float wanted = march.sample_distance > 0.0 ? depth * ray.world_per_z / march.sample_distance
                                             : depth * length(l.direction) / stride;
  float steps = clamp(ceil(wanted), 1.0, 1e5), share = depth / steps;
  float scalar_front = sample_lattice(l, z);
  Front front = front_at(scalar_front);
  float number = 0.0;
  while (number < steps && !ends_pass(z + number * share, z)) {
    number += 1.0;
    float scalar_back = sample_lattice(l, z + number * share);
    integrate(Segment(scalar_front, scalar_back, share * ray.world_per_z), front, sum);
    scalar_front = scalar_back;
    ++work_done;
  }
  segments += uint(number);
  return number < steps ? z + number * share : leave;
}

// From cell to cell; how far it came.
float march_cells(GridRay ray, Lattice l, uvec4 plan, float z, float leave, inout vec4 sum, inout uint segments) {
  float steepness = (plan.x & kIsCurved) != 0u ? uintBitsToFloat(plan.y) : 0.0;
  CellWalk walk = enter_lattice(ray, l, z, leave);
  Front front;
  bool is_fresh = true;
  float scalar_front = 0.0;
  while (walk.front < leave && !ends_pass(walk.front, z)) {
    vec4 low, high;
    fetch_corners(l, walk.cell, low, high);
    float back = back_of(walk), world = (back - walk.front) * ray.world_per_z;
    vec4 cubic = make_cubic(low, high, place_in_cell(ray, l, walk.cell, walk.front),
                            place_in_cell(ray, l, walk.cell, back));
    float pieces = 0.0, cell_back = cubic.x + cubic.y + cubic.z + cubic.w;
    if (is_missing((low.x + low.y + low.z + low.w) + (high.x + high.y + high.z + high.w))) {
      is_fresh = true;  // a cell with a corner that is missing is transparent; behind it the ray sets out anew
    } else {
      if (is_fresh) {
        scalar_front = cubic.x;
        front = front_at(scalar_front);
        is_fresh = false;
      }
      pieces = count_pieces(cubic, steepness, sum.a, cell_back);
    }
    for (float number = 1.0; number <= pieces; number += 1.0) {
      float reached = walk.front + (back - walk.front) * (number - 1.0) / pieces;
      if (ends_pass(reached, z)) return reached;
      float scalar_back = number >= pieces ? cell_back : eval_cubic(cubic, number / pieces);
      integrate(Segment(scalar_front, scalar_back, world / pieces), front, sum);
      scalar_front = scalar_back;
      ++work_done;
    }
    leave_cell(ray, l, back, walk);
    ++segments;
    ++work_done;
  }
  return walk.front;
}

// How far it came.
float march_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout vec4 sum, inout uint segments) {
  Lattice l = lattice_of(ray, brick, plan);
  uint stride = plan.x >> 8 & 0xFFu;
  if (stride > 0u) return march_strides(ray, l, float(stride), z, leave, sum, segments);
  return march_cells(ray, l, plan, z, leave, sum, segments);
}
