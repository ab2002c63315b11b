// Map 0 of the polynomial: colour of thin segments, and mean extinction.

#include "tables/maker.glsl"

layout(binding = 13) uniform sampler2D densities;  // means of density / largest extinction
layout(binding = 14) uniform sampler2D colors;     // means of colour, for segments that nothing is seen of
layout(location = 0) out vec4 coefficient;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec4 density = texelFetch(densities, texel, 0);
  bool is_seen = density.a * maker.most_extinction * maker.longest_length > 1e-9;
  vec3 color = is_seen ? density.rgb / density.a : texelFetch(colors, texel, 0).rgb;
  coefficient = vec4(color, density.a * maker.most_extinction);
}
