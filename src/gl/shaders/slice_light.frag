// Takes the light through a slab: what comes straight is absorbed, what is scattered spreads on its way and loses less
// of the slab's own colour (Kniss, Premoze, Hansen, Ebert, McPherson 2003).

#include "slice.glsl"
#include "slice_field.glsl"
#include "slice_classify.glsl"

layout(binding = 9) uniform sampler2D light_before;
layout(location = 0) uniform int slab;
layout(location = 0) out vec4 light_behind;

// Of the scattered light, over the cone that it comes from: the place itself, and eight round it.
vec3 spread_light(vec2 at) {
  vec3 sum = textureLod(light_before, at, 0.0).rgb;
  for (int i = 0; i < 8; ++i) {
    float angle = 0.78539816 * float(i);
    sum += textureLod(light_before, at + slices.blur_radius * vec2(cos(angle), sin(angle)), 0.0).rgb;
  }
  return sum / 9.0;
}

void main() {
  vec2 at = gl_FragCoord.xy / vec2(textureSize(light_before, 0));
  // Backwards from the place in the buffer to where the ray goes.
  vec3 x = slices.light_x.xyz / dot(slices.light_x.xyz, slices.light_x.xyz);
  vec3 y = slices.light_y.xyz / dot(slices.light_y.xyz, slices.light_y.xyz);
  vec3 base = x * (at.x - slices.light_x.w) + y * (at.y - slices.light_y.w);
  Path path = make_path(base, slices.light_z.xyz, -1e30, frame.world_per_local);
  vec2 whole = span_in_box(path), span = span_in_slab(path, slab);
  vec4 before = texelFetch(light_before, ivec2(gl_FragCoord.xy), 0);
  vec3 scattered = spread_light(at);
  vec4 sum = kNothingYet;
  if (span.x < span.y) {
    Sample front = front_sample(path, span.x, 0), back = back_sample(path, span.y, 0);
    if (!is_missing(front) && !is_missing(back)) classify(path, front, back, 0, sum);
  }
  vec3 color = sum.rgb / max(1.0 - sum.a, 1e-6);
  vec3 lost = clamp(1.0 - slices.translucency * color, 0.0, 1.0);
  light_behind = vec4(scattered * pow(vec3(max(sum.a, 1e-30)), lost), whole.x < whole.y ? before.a * sum.a : -1.0);
}
