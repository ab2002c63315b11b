// Full pre-integration (Roettger, Kraus, Ertl 2000): `optics::eval_preintegration_table`, interpolated by the device.

#include "integrators/preintegration.glsl"
#include "integrators/whole_segments.glsl"

layout(binding = 4) uniform sampler3D ray_integrals;  // [lengths][back][front], divided by the opacity bound

void integrate_whole(Segment segment, inout vec4 sum) {
  float share = min(segment.world_length, domain.longest) / domain.longest;
  vec3 at = vec3(texel_place(scalar_place(segment.scalar_front), domain.scalars),
                 texel_place(scalar_place(segment.scalar_back), domain.scalars),
                 texel_place(length_place(share), domain.lengths));
  composite(textureLod(ray_integrals, at, 0.0) * opacity_bound(segment.world_length), sum);
}
