// Values of a grid from a 3D texture that holds four of them in each texel (src/gl/grid_textures.h), fetched as they are.

layout(binding = 10) uniform sampler3D squares;  // (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)

// Corners of a cell: lower or upper (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
void fetch_corners(Lattice l, ivec3 cell, out vec4 low, out vec4 high) {
  ivec3 at = l.first + (cell << l.level);  // larger cells are constant
  low = march.texel_offset + march.texel_scale * texelFetch(squares, at, 0);
  high = march.texel_offset + march.texel_scale * texelFetch(squares, at + ivec3(0, 0, 1), 0);
}
