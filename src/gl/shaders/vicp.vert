// The source `vicp`: faces of cells that look at the eye, twelve vertices a cell. A cell that holds the eye has none:
// it covers the whole picture.

#include "projection.glsl"

layout(binding = 6) uniform samplerBuffer vertices;        // [vertices] camera frame or mesh's, stored scalar
layout(binding = 9) uniform samplerBuffer cell_scalars;    // [cells], with cell data
layout(binding = 10) uniform usamplerBuffer cell_vertices; // [cells], as they are or in order
layout(binding = 11) uniform usamplerBuffer order;         // [cells]

flat out vec4 corners[4];  // camera frame, stored scalar

const uint kUnknown = 0xFFFFFFFFu;

vec4 see(vec4 vertex) {
  precise vec3 seen = vec3(dot(projection.right.xyz, vertex.xyz), dot(projection.up.xyz, vertex.xyz),
                           dot(projection.forward.xyz, vertex.xyz));
  return vec4(seen, vertex.w);
}

vec3 to_eye(vec3 p) {
  return frame.is_orthographic != 0 ? vec3(0.0, 0.0, -1.0) : vec3(frame.eye_x, frame.eye_y, frame.eye_z) - p;
}

// 1 where the eye is on the same side of the face opposite `k` as the corner there, -1 where it is on the other side.
int side_of_eye(int k) {
  vec3 a = corners[(k + 1) & 3].xyz, b = corners[(k + 2) & 3].xyz, c = corners[(k + 3) & 3].xyz;
  vec3 normal = cross(b - a, c - a);
  return int(sign(dot(normal, to_eye(a))) * sign(dot(normal, corners[k].xyz - a)));
}

vec4 project_place(vec3 p) {
  vec2 half_size = 0.5 * vec2(frame.width, frame.height) * frame.pixel_step;
  float w = frame.is_orthographic != 0 ? 1.0 : p.z - frame.eye_z;
  return vec4((p.x - frame.eye_x) / half_size.x, (frame.eye_y - p.y) / half_size.y, 0.0, w);
}

void main() {
  int place = gl_VertexID / 12, face = gl_VertexID % 12 / 3, corner = gl_VertexID % 3;
  int cell = projection.is_ordered != 0 ? int(texelFetch(order, place).x) : place;
  uvec4 ids = texelFetch(cell_vertices, cell);
  gl_Position = vec4(2.0, 2.0, 0.0, 1.0);  // outside: nothing is drawn
  for (int k = 0; k < 4; ++k) corners[k] = vec4(0.0);
  if (ids.x == kUnknown) return;
  for (int k = 0; k < 4; ++k) {
    corners[k] = see(texelFetch(vertices, int(ids[k])));
#ifdef CELL_DATA
    corners[k].w = texelFetch(cell_scalars, cell).x;
#endif
  }
  bool holds_eye = frame.is_orthographic == 0;
  for (int k = 0; k < 4; ++k) holds_eye = holds_eye && side_of_eye(k) > 0;
  if (holds_eye) {
    if (face == 0) gl_Position = vec4(corner == 1 ? 3.0 : -1.0, corner == 2 ? 3.0 : -1.0, 0.0, 1.0);
  } else if (side_of_eye(face) < 0) {
    gl_Position = project_place(corners[(face + 1 + corner) & 3].xyz);
  }
}
