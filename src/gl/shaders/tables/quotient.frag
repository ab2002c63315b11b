// What tables keep of ray integrals: divided by the opacity bound of the length.

#include "tables/maker.glsl"

layout(binding = 13) uniform sampler2D before;
layout(location = 0) out vec4 entry;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec4 sum = texelFetch(before, texel, 0);
  float share = slab_of(texel).share;
  entry = rounded(share > 0.0 ? sum / bound_of(share) : sum);
}
