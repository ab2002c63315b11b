// The table of ray integrals in sheared cylindrical coordinates (Roettger and Ertl 2002):
// `optics::eval_cylindrical_atlas`, each tile interpolated by the device.

#include "integrators/preintegration.glsl"
#include "integrators/whole_segments.glsl"

layout(binding = 4) uniform sampler2D atlas;  // [rows * tile][columns * tile], divided by the opacity bound

vec4 look_up_plane(int plane, vec2 place) {
  vec2 corner = vec2(plane % domain.columns, plane / domain.columns) * float(domain.tile);
  vec2 at = corner + place * float(domain.tile - 1) + 0.5;
  return textureLod(atlas, at / vec2(textureSize(atlas, 0)), 0.0);
}

void integrate_whole(Segment segment, inout vec4 sum) {
  float front = scalar_place(segment.scalar_front), back = scalar_place(segment.scalar_back);
  float difference = back - front, share = min(segment.world_length, domain.longest) / domain.longest;
  float slant = abs(difference), radius = max(slant, share), divisor = max(radius, 1e-30);
  float turn = slant > share ? 2.0 - share / divisor : slant / divisor;
  if (difference < 0.0) turn = -turn;
  float at = (turn + 2.0) * 0.25 * float(domain.planes - 1);
  int plane = clamp(int(at), 0, domain.planes - 2);
  vec2 place = vec2(min(min(front, back) / max(1.0 - slant, 1e-6), 1.0), radius);
  vec4 quotient = mix(look_up_plane(plane, place), look_up_plane(plane + 1, place), at - float(plane));
  composite(quotient * opacity_bound(segment.world_length), sum);
}
