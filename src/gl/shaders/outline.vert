// The source `project`: outlines of cells, as src/gl/decomposition.h makes them.

#include "projected_cells.glsl"

layout(location = 0) in vec2 place;      // clip space
layout(location = 1) in uint in_order;

void main() {
  fetch_corners(int(in_order));
  entered_face = -1;
  gl_Position = vec4(place, 0.0, 1.0);
}
