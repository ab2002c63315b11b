// Values of a grid from a 3D texture, between them as the device filters it.

layout(binding = 9) uniform sampler3D values;

float sample_values(vec3 at) {
  vec3 place = (at + 0.5) * vec3(march.texel_x, march.texel_y, march.texel_z);
  return march.texel_offset + march.texel_scale * textureLod(values, place, 0.0).x;
}
