// The source `vicp`: faces of cells that may look at the eye, twelve vertices a cell. A cell that holds the eye has none,
// and faces that reach behind the eye cannot be moved out: these cells cover the whole picture.

#include "projected_cells.glsl"

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
  gl_Position = vec4(2.0, 2.0, 0.0, 1.0);  // outside: nothing is drawn
  if (!fetch_corners(place)) return;
  bool is_at_eye = is_around_eye();
  entered_face = is_at_eye ? -1 : face;
  if (is_at_eye && is_out_of_sight()) return;
  if (is_at_eye) {
    if (face == 0) gl_Position = vec4(corner == 1 ? 3.0 : -1.0, corner == 2 ? 3.0 : -1.0, 0.0, 1.0);
  } else if (side_of_eye(face) < 1e-5) {
    gl_Position = project_outside(face, corner);
  }
}
