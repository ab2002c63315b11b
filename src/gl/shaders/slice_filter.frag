// One tile of a filter's kernel times the values that it falls on, added up over all tiles in a slice (Hadwiger,
// Theussl, Hauser, Groeller 2001: values are distributed to what lies round them, instead of gathered from it).
//
// A tile is what one value gives to the places of the cell it is seen from: kernels are separable, and their tiles
// along one axis a table over the place in the cell.

#include "slice.glsl"

layout(binding = 6) uniform sampler3D values;
layout(binding = 9) uniform samplerBuffer kernel_tiles;  // [phases + 1][2 radius]: weight, its derivative

flat in ivec2 piece;
flat in int tile;
layout(location = 0) out vec4 part;

vec2 weight_of(int tile_along, float share) {
  int width = 2 * slices.kernel_radius, phases = textureSize(kernel_tiles) / width - 1;
  float at = share * float(phases);
  int phase = min(int(at), phases - 1);
  vec2 low = texelFetch(kernel_tiles, phase * width + tile_along).xy;
  vec2 high = texelFetch(kernel_tiles, (phase + 1) * width + tile_along).xy;
  return mix(low, high, at - float(phase));
}

void main() {
  Path path = path_of_pixel(ivec2(gl_FragCoord.xy));
  vec2 span = span_in_box(path);
  if (!(span.x < span.y)) discard;
  vec3 place = place_at(path, clamp(z_of_slice(path, piece.x), span.x, span.y)) + slices.value_shift;
  ivec3 cells = ivec3(slices.upper.xyz - slices.lower.xyz + 0.5);
  ivec3 cell = clamp(ivec3(floor(place)), ivec3(0), cells - 1);
  vec3 share = clamp(place - vec3(cell), 0.0, 1.0);
  int width = 2 * slices.kernel_radius;
  ivec3 at = ivec3(tile % width, tile / width % width, tile / (width * width));
  // Places beyond the border have the value of the nearest; coefficients have a margin of their own.
  int margin = (textureSize(values, 0).x - cells.x - 1) / 2;
  ivec3 index = clamp(cell + at - slices.kernel_radius + 1 + margin, ivec3(0), textureSize(values, 0) - 1);
  float value = slices.texel_offset + slices.texel_scale * texelFetch(values, index, 0).x;
  vec2 x = weight_of(at.x, share.x), y = weight_of(at.y, share.y), z = weight_of(at.z, share.z);
  part = value * vec4(x.y * y.x * z.x, x.x * y.y * z.x, x.x * y.x * z.y, x.x * y.x * z.x);
}
