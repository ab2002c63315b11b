// The nearest face that a ray enters through behind the last one.

#include "mesh.glsl"
#include "peeling.glsl"

flat in uint face;
layout(location = 0) out uint front_face;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  MetFace met = meet_face(ray_of(pixel), face);
  float depth = interpolate(max(met.weight, 0.0), met.z, met.z[0]);
  float key = key_of(face, depth);
  Peeled last = peeled[place_of(pixel)];
  bool is_next = key > last.key || (key == last.key && face > last.face);
  if (!is_entered(met) || is_before_eye(face, depth) || !is_next) discard;
  gl_FragDepth = key;
  front_face = face;
}
