// Depth peeling of the boundary (Everitt 2001; Weiler et al. 2003): a layer is the next face that each ray enters
// through. Faces of one depth go by their number, so that none is lost.

struct Peeled {
  float key;  // of the face that the ray entered through last
  uint face;
};
layout(std430, binding = 4) buffer PeeledFaces { Peeled peeled[]; };  // [rows][width]

const float kBeforeAll = -1.0;
const float kBehindAll = 2.0;

// A depth for the depth buffer: local lengths are below sqrt(3). Faces around the eye come first.
float key_of(uint face, float depth) {
  return face >= walk.first_eye_face ? 0.0 : clamp(0.5 + 0.25 * depth, 0.001, 1.0);
}
