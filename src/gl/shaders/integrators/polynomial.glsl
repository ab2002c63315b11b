// Separable opacity and chromaticity as a polynomial of the length (Guthe, Roettger, Schieber, Strasser, Ertl 2002):
// `optics::eval_polynomial_table`, interpolated by the device. DEGREE; LINEAR_OPACITY for comparison.

#include "integrators/preintegration.glsl"
#include "integrators/whole_segments.glsl"

layout(binding = 4) uniform sampler2DArray coefficients;   // [degree + 1][back][front]: colour; mean extinction in map 0
layout(binding = 5) uniform sampler2D absorbed_ratios;     // (1 - exp(-x)) / x over x in [0, kDeepest]

float opacity_of(float depth) {
#ifdef LINEAR_OPACITY
  return min(depth, 1.0);
#else
  const float kDeepest = 12.0;
  int count = textureSize(absorbed_ratios, 0).x;
  float ratio = textureLod(absorbed_ratios, vec2(texel_place(min(depth / kDeepest, 1.0), count), 0.5), 0.0).x;
  return depth < kDeepest ? depth * ratio : 1.0;
#endif
}

void integrate_whole(Segment segment, inout vec4 sum) {
  float inside = min(segment.world_length, domain.longest), t = inside / domain.longest;
  vec2 at = vec2(texel_place(scalar_place(segment.scalar_front), domain.scalars),
                 texel_place(scalar_place(segment.scalar_back), domain.scalars));
  vec4 value = textureLod(coefficients, vec3(at, float(DEGREE)), 0.0);
  vec3 color = value.rgb;
  for (int map = DEGREE - 1; map >= 0; --map) {
    value = textureLod(coefficients, vec3(at, float(map)), 0.0);
    color = color * t + value.rgb;
  }
  float opacity = opacity_of(value.a * inside);
  composite(vec4(clamp(color, 0.0, 1.0) * opacity, opacity), sum);
}
