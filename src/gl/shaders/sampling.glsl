// The field of an even lattice anywhere in it, and equal steps along a ray.

float mix_corners(vec4 low, vec4 high, vec3 t) {
  vec4 square = mix(low, high, t.z);
  vec2 edge = mix(square.xy, square.zw, t.y);
  return mix(edge.x, edge.y, t.x);
}

// The field of an even lattice anywhere in it; where the device filters, of one that is the whole grid.
float sample_lattice(Lattice l, float z) {
  vec3 at = l.origin + l.direction * z;
#ifdef IS_FILTERED
  return sample_values(at);
#else
  ivec3 cell = ivec3(clamp(at, vec3(0.0), vec3(l.size - 1)));
  vec4 low, high;
  fetch_corners(l, cell, low, high);
  return mix_corners(low, high, at - vec3(cell));
#endif
}

// Into how many steps a ray's way through a brick is cut.
float count_strides(GridRay ray, Lattice l, float stride, float depth) {
  float wanted = march.sample_distance > 0.0 ? depth * ray.world_per_z / march.sample_distance
                                             : depth * length(l.direction) / stride;
  return clamp(ceil(wanted), 1.0, 1e5);
}
