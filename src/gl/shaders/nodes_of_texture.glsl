// Values of a grid from a 3D texture, fetched as they are.

layout(binding = 9) uniform sampler3D values;

float fetch_value(ivec3 at) { return march.texel_offset + march.texel_scale * texelFetch(values, at, 0).x; }

// Corners of a cell: lower or upper (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
void fetch_corners(Lattice l, ivec3 cell, out vec4 low, out vec4 high) {
  ivec3 at = l.first + (cell << l.level);
  ivec3 to = at + 1;  // of larger cells, which are constant, any corner is as good
  low = vec4(texelFetch(values, at, 0).x, texelFetch(values, ivec3(to.x, at.yz), 0).x,
             texelFetch(values, ivec3(at.x, to.y, at.z), 0).x, texelFetch(values, ivec3(to.xy, at.z), 0).x);
  high = vec4(texelFetch(values, ivec3(at.xy, to.z), 0).x, texelFetch(values, ivec3(to.x, at.y, to.z), 0).x,
              texelFetch(values, ivec3(at.x, to.yz), 0).x, texelFetch(values, to, 0).x);
  low = march.texel_offset + march.texel_scale * low;
  high = march.texel_offset + march.texel_scale * high;
}
