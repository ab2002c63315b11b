// The source `vicp`: faces of cells that may look at the eye, twelve vertices a cell. A cell that holds the eye has none,
// and faces that reach behind the eye cannot be moved out: these cells cover the whole picture.

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

vec3 to_eye(vec3 p) {
  return frame.is_orthographic != 0 ? vec3(0.0, 0.0, -1.0) : vec3(frame.eye_x, frame.eye_y, frame.eye_z) - p;
}

// How far the eye is on the side of the face opposite `k` where the corner is: below 0 the face looks at the eye, to
// within rounding about 1e-6.
float side_of_eye(int k) {
  vec3 a = corners[(k + 1) & 3].xyz, b = corners[(k + 2) & 3].xyz, c = corners[(k + 3) & 3].xyz;
  vec3 normal = cross(b - a, c - a), arm = to_eye(a);
  float scale = length(normal) * length(arm);
  return scale > 0.0 ? dot(normal, arm) * sign(dot(normal, corners[k].xyz - a)) / scale : 0.0;
}

vec2 half_size() { return 0.5 * vec2(frame.width, frame.height) * frame.pixel_step; }

vec4 project_place(vec3 p) {
  float w = frame.is_orthographic != 0 ? 1.0 : p.z - frame.eye_z;
  return vec4(vec2(p.x - frame.eye_x, frame.eye_y - p.y) / half_size(), 0.0, w);
}

// Corner `k` of the face, moved out so that every pixel centre in the face is covered however places are rounded
// (Hasselgren, Akenine-Moeller, Ohlsson 2005); which of them are in it the fragment finds out.
vec4 project_outside(int face, int k) {
  const float kMargin = 1.0 / 64.0, kFarthest = 2.0;  // pixels
  vec4 at[3];
  for (int i = 0; i < 3; ++i) at[i] = project_place(corners[(face + 1 + i) & 3].xyz);
  vec2 size = 0.5 * vec2(frame.width, frame.height);
  vec2 middle = at[k].xy / at[k].w * size;
  vec2 u = at[(k + 1) % 3].xy / at[(k + 1) % 3].w * size - middle, v = at[(k + 2) % 3].xy / at[(k + 2) % 3].w * size - middle;
  u /= max(length(u), 1e-6);
  v /= max(length(v), 1e-6);
  vec2 out_of_it = -(u + v) * (kMargin / max(abs(u.x * v.y - u.y * v.x), 1e-6));
  out_of_it *= min(1.0, kFarthest / max(length(out_of_it), 1e-6));
  return vec4((middle + out_of_it) / size * at[k].w, 0.0, at[k].w);
}

bool is_around_eye() {
  if (frame.is_orthographic != 0) return false;
  float nearest = min(min(corners[0].z, corners[1].z), min(corners[2].z, corners[3].z)) - frame.eye_z;
  if (nearest < 1e-5) return true;
  for (int k = 0; k < 4; ++k)
    if (side_of_eye(k) <= 0.0) return false;
  return true;
}

// Whether all corners are beyond one side of the picture, or behind the eye.
bool is_out_of_sight() {
  bool right = true, left = true, above = true, below = true, behind = true;
  for (int k = 0; k < 4; ++k) {
    vec4 at = project_place(corners[k].xyz);
    right = right && at.x > at.w;
    left = left && at.x < -at.w;
    above = above && at.y > at.w;
    below = below && at.y < -at.w;
    behind = behind && at.w < 0.0;
  }
  return right || left || above || below || behind;
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
  bool is_at_eye = is_around_eye();
  entered_face = is_at_eye ? -1 : face;
  if (is_at_eye && is_out_of_sight()) return;
  if (is_at_eye) {
    if (face == 0) gl_Position = vec4(corner == 1 ? 3.0 : -1.0, corner == 2 ? 3.0 : -1.0, 0.0, 1.0);
  } else if (side_of_eye(face) < 1e-5) {
    gl_Position = project_outside(face, corner);
  }
}
