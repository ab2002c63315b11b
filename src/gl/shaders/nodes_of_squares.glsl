// Values of a grid from a 3D texture that holds four of them in each texel (src/gl/grid_textures.h), as they are: the
// texture is not filtered, and looked up at the middles of texels. Software renderers do that in place, where texelFetch
// is a call.

layout(binding = 10) uniform sampler3D squares;  // (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)

vec4 fetch_square(vec3 middle) { return textureLod(squares, middle, 0.0); }

// Corners of a cell: lower or upper (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
void fetch_corners(Lattice l, ivec3 cell, out vec4 low, out vec4 high) {
  ivec3 at = l.first + (cell << l.level);  // larger cells are constant
  vec3 middle = (vec3(at) + 0.5) * vec3(march.texel_x, march.texel_y, march.texel_z);
  low = march.texel_offset + march.texel_scale * fetch_square(middle);
  high = march.texel_offset + march.texel_scale * fetch_square(middle + vec3(0.0, 0.0, march.texel_z));
}
