// Cells in order, as vertex shaders hand them to fragments.

#include "projection.glsl"

layout(binding = 6) uniform samplerBuffer vertices;        // [vertices] camera frame or mesh's, stored scalar
layout(binding = 9) uniform samplerBuffer cell_scalars;    // [cells], with cell data
layout(binding = 7) uniform usamplerBuffer cell_vertices;  // [cells], as they are or in order
layout(binding = 8) uniform usamplerBuffer order;          // [cells]

flat out vec4 corners[4];  // camera frame, stored scalar
flat out int entered_face;  // opposite which corner; -1: any

const uint kUnknown = 0xFFFFFFFFu;

vec4 see(vec4 vertex) {
  precise vec3 seen = vec3(dot(projection.right.xyz, vertex.xyz), dot(projection.up.xyz, vertex.xyz),
                           dot(projection.forward.xyz, vertex.xyz));
  return vec4(seen, vertex.w);
}

// The corners of the cell at a place of the order; false: it has none that are known.
bool fetch_corners(int place) {
  int cell = projection.is_ordered != 0 ? int(texelFetch(order, place).x) : place;
  uvec4 ids = texelFetch(cell_vertices, cell);
  for (int k = 0; k < 4; ++k) corners[k] = vec4(0.0);
  if (ids.x == kUnknown) return false;
  for (int k = 0; k < 4; ++k) {
    corners[k] = see(texelFetch(vertices, int(ids[k])));
#ifdef CELL_DATA
    corners[k].w = texelFetch(cell_scalars, cell).x;
#endif
  }
  return true;
}
