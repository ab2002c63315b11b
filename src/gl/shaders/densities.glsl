// Pre-classification (Wittenbrink, Malzbender, Goss 1998): extinction and extinction times colour at the corners of
// cells, interpolated.

#include "march.glsl"
#include "integrator.glsl"

struct DensityCorners {
  vec4 corner[8];  // x first
  bool is_complete;
};

#ifdef HAS_NODES
layout(binding = 9) uniform samplerBuffer nodes;  // [bricks][z][y][x] filtered densities

DensityCorners fetch_densities(Lattice l, ivec3 cell) {
  DensityCorners corners;
  int row = l.size.x + 1, slice = row * (l.size.y + 1), first = l.nodes + cell.z * slice + cell.y * row + cell.x;
  corners.is_complete = true;
  for (int i = 0; i < 8; ++i) {
    corners.corner[i] = texelFetch(nodes, first + (i & 1) + (i >> 1 & 1) * row + (i >> 2) * slice);
    corners.is_complete = corners.is_complete && !is_missing(corners.corner[i].x);
  }
  return corners;
}
#else
#include "nodes.glsl"

DensityCorners fetch_densities(Lattice l, ivec3 cell) {
  DensityCorners corners;
  corners.is_complete = true;
  for (int i = 0; i < 8; ++i) {
    float value = fetch_value(l.first + cell + ivec3(i & 1, i >> 1 & 1, i >> 2));
    corners.is_complete = corners.is_complete && !is_missing(value);
    vec4 optics = eval_optics(is_missing(value) ? 0.0 : value);
    corners.corner[i] = vec4(optics.x, optics.x * optics.yzw);
  }
  return corners;
}
#endif

vec4 eval_densities(DensityCorners c, vec3 t) {
  vec4 low = mix(mix(c.corner[0], c.corner[1], t.x), mix(c.corner[2], c.corner[3], t.x), t.y);
  vec4 high = mix(mix(c.corner[4], c.corner[5], t.x), mix(c.corner[6], c.corner[7], t.x), t.y);
  return mix(low, high, t.z);
}

// Adds a piece with these mean densities. Kernels with negative lobes may overshoot what is possible.
void composite_densities(vec4 mean, float world, inout vec4 sum) {
  float depth = max(mean.x * world, 0.0);
  composite_piece(depth, clamp(mean.yzw * world, 0.0, depth), sum);
}
