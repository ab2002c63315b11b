// Counts the rays that meet the box.

#include "slice.glsl"

flat in ivec2 piece;
layout(location = 0) out vec4 color;

void main() {
  vec2 span = span_in_box(path_of_pixel(ivec2(gl_FragCoord.xy)));
  if (!(span.x < span.y)) discard;
  color = vec4(0.0);
}
