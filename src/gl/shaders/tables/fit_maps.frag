// What the chromaticity at one length adds to the further coefficients of the polynomial; blended.

#include "tables/maker.glsl"

layout(binding = 13) uniform sampler2D integrals;
layout(binding = 14) uniform sampler2D thin;  // map 0
layout(binding = 15) uniform samplerBuffer fit_weights;  // [1]: of this length, in coefficients 1 to 4
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
layout(location = 2) out vec4 third;
layout(location = 3) out vec4 fourth;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec4 integral = texelFetch(integrals, texel, 0);
  vec3 bend = integral.a > 1e-6 ? integral.rgb / integral.a - texelFetch(thin, texel, 0).rgb : vec3(0.0);
  vec4 weights = texelFetch(fit_weights, 0);
  first = vec4(weights.x * bend, 0.0);
  second = vec4(weights.y * bend, 0.0);
  third = vec4(weights.z * bend, 0.0);
  fourth = vec4(weights.w * bend, 0.0);
}
