// Some steps of the integration of all entries of a slice at once (Roettger and Ertl 2002; Guthe et al. 2002): samples of
// the function, blended front to back into what the steps before have left.

#include "tables/maker.glsl"

layout(binding = 13) uniform sampler2D before;  // premultiplied colour, opacity
layout(location = 0) out vec4 after;

// What is gathered: ray integrals; means of density / largest extinction, for segments of no length; means of colour.
const int kIntegrals = 0, kDensities = 1, kColors = 2;

vec4 function_at(float place) {
  float at = place * float(maker.node_count - 1);
  int node = min(int(at), maker.node_count - 2);
  return mix(texelFetch(function_nodes, node), texelFetch(function_nodes, node + 1), at - float(node));
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  Slab slab = slab_of(texel);
  float part = 1.0 / float(maker.step_count), len = slab.share * maker.longest_length * part;
  bool is_thin = maker.mode != kIntegrals || slab.share == 0.0;
  vec4 sum = maker.step_begin == 0 ? vec4(0.0) : texelFetch(before, texel, 0);
  for (int i = maker.step_begin; i < maker.step_end; ++i) {
    vec4 optics = function_at(mix(slab.front, slab.back, (float(i) + 0.5) * part));
    float opacity = opacity_of(optics.x * len);
    vec4 blended = sum + (1.0 - sum.a) * vec4(opacity * optics.yzw, opacity);
    float density = maker.mode == kColors ? 1.0 : optics.x / maker.most_extinction;
    vec4 added = sum + part * density * vec4(optics.yzw, 1.0);
    sum = is_thin ? added : rounded(blended);
  }
  after = sum;
}
