// The boundary's faces, each as the rectangle of pixels that it may cover: six vertices a face.

#include "mesh.glsl"

flat out uint face;

vec4 low_high = vec4(1e30, 1e30, -1e30, -1e30);  // of the face in the picture, pixels

void add_point(vec3 p) {
  float scale = 1.0 / frame.pixel_step;
  if (frame.is_orthographic == 0) scale /= p.z - frame.eye_z;
  vec2 at = vec2((p.x - frame.eye_x) * scale + 0.5 * float(frame.width),
                 0.5 * float(frame.height) - (p.y - frame.eye_y) * scale);
  low_high = vec4(min(low_high.xy, at), max(low_high.zw, at));
}

// The part of the face in front of the eye.
void add_face(vec3 p[3]) {
  if (frame.is_orthographic != 0) {
    for (int k = 0; k < 3; ++k) add_point(p[k]);
    return;
  }
  float z_cut = frame.eye_z + 1e-6 * max(1.0, abs(frame.eye_z));
  for (int k = 0; k < 3; ++k) {
    vec3 a = p[k], b = p[(k + 1) % 3];
    if (a.z >= z_cut) add_point(a);
    if ((a.z < z_cut) != (b.z < z_cut)) add_point(vec3(mix(a.xy, b.xy, (z_cut - a.z) / (b.z - a.z)), z_cut));
  }
}

// Whether the face is certainly seen from its inner side.
bool is_turned_away(vec3 p[3]) {
  vec3 u = p[1] - p[0], v = p[2] - p[0];
  vec3 to_eye = frame.is_orthographic != 0 ? vec3(0.0, 0.0, -1.0) : vec3(frame.eye_x, frame.eye_y, frame.eye_z) - p[0];
  // x right, y up, z forward is a left-handed frame: the outward normal is v x u.
  return dot(cross(v, u), to_eye) < -1e-4 * length(u) * length(v) * length(to_eye);
}

void main() {
  face = uint(gl_VertexID) / 6u;
  uvec4 links = texelFetch(faces, int(face));
  vec3 p[3];
  for (int k = 0; k < 3; ++k) p[k] = texelFetch(vertices, int(links[k + 1])).xyz;
  gl_Position = vec4(2.0, 2.0, 0.0, 1.0);  // outside: nothing is drawn
  if (face >= walk.first_eye_face) {
    // Rays entered it before they came to the eye, wherever they go from there.
    low_high = vec4(0.0, 0.0, frame.width, frame.height);
  } else {
    if (is_turned_away(p)) return;
    add_face(p);
    if (low_high.x > low_high.z) return;
  }
  // Half a pixel and a bit more, so that every centre that may be inside is drawn.
  low_high = clamp(low_high + vec4(-0.6, -0.6, 0.6, 0.6), vec4(-1.0), vec4(frame.width, frame.height, frame.width, frame.height) + 1.0);
  int corner = int(gl_VertexID) % 6;
  bool is_right = corner == 1 || corner == 2 || corner == 4, is_high = corner == 2 || corner == 4 || corner == 5;
  vec2 at = vec2(is_right ? low_high.z : low_high.x, is_high ? low_high.w : low_high.y);
  gl_Position = vec4(2.0 * at / vec2(frame.width, frame.height) - 1.0, 0.0, 1.0);
}
