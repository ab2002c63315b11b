// The source `project`: vertices as src/gl/decomposition.h makes them.

layout(location = 0) in vec2 place;    // clip space
layout(location = 1) in vec4 carried;

noperspective out vec4 ends;
#ifdef CELL_DATA
flat out float cell_scalar;
#endif

void main() {
  ends = carried;
#ifdef CELL_DATA
  cell_scalar = carried.z;  // of the thick vertex, the last of every triangle
#endif
  gl_Position = vec4(place, 0.0, 1.0);
}
