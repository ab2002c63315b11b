// Triangles that cover slabs, in pixels.

#include "frame.glsl"

layout(location = 0) in vec2 position;
layout(location = 1) in ivec2 slab_and_stripe;

flat out ivec2 piece;
flat out int tile;  // of a filter's kernel

void main() {
  piece = slab_and_stripe;
  tile = gl_InstanceID;
  // Pixels count from the upper row, as rows of the picture do.
  gl_Position = vec4(2.0 * position / vec2(frame.width, frame.height) - 1.0, 0.0, 1.0);
}
