// Gradients from a texture of central differences, linear in between. In grid coordinates.

layout(binding = 7) uniform sampler3D gradients;

vec3 gradient_between(Path path, Sample front, Sample back, float share) {
  vec3 place = place_at(path, mix(front.z, back.z, share));
#ifdef CONSTANT
  return texelFetch(gradients, nearest_value(place + slices.value_shift, textureSize(gradients, 0)), 0).xyz;
#else
  return textureLod(gradients, (place + slices.value_shift + 0.5) / vec3(textureSize(gradients, 0)), 0.0).xyz;
#endif
}
