// Puts a face into the lists of the pixels whose rays enter through it.

#include "mesh.glsl"
#include "lists.glsl"

flat in uint face;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  MetFace met = meet_face(ray_of(pixel), face);
  if (!is_entered(met)) return;
  float depth = interpolate(max(met.weight, 0.0), met.z, met.z[0]);
  if (is_before_eye(face, depth)) return;
  uint entry = atomicAdd(counters.entry_count, 1u);
  if (entry >= walk.node_count) return;
  entries[entry].face = face;
  entries[entry].depth = depth;
  entries[entry].next = atomicExchange(heads[place_of(pixel)], entry);
}
