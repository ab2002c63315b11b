// Blinn-Phong (Blinn 1977) as in Engel and Ertl 2002: the formulas of src/cpu/kernels/shading-inl.h.

struct Illumination {
  vec3 diffuse;   // times the emitted colour
  vec3 specular;  // added to it
};

float facing(float cosine) { return slices.is_two_sided != 0 ? abs(cosine) : max(cosine, 0.0); }

vec3 camera_gradient(vec3 g) { return slices.grid_x.xyz * g.x + slices.grid_y.xyz * g.y + slices.grid_z.xyz * g.z; }

// `gradient`: stored scalars a local length, camera frame. `reaching`: part of the light that comes through.
Illumination illuminate(vec3 gradient, vec3 to_eye, bool is_surface, vec3 reaching) {
  const float kLeast = 1e-30;
  float square = dot(gradient, gradient);
  vec3 normal = gradient * (-inversesqrt(max(square, kLeast)));
  if (slices.is_two_sided != 0 && dot(normal, to_eye) < 0.0) normal = -normal;
  float strength = square / max(square + slices.half_strength, kLeast);
  if (is_surface) strength = square > kLeast ? 1.0 : 0.0;
  Illumination light = Illumination(vec3(slices.ambient), vec3(0.0));
  for (int i = 0; i < slices.light_count; ++i) {
    vec4 source = slices.light_vectors[i];
    vec3 to_light = source.w != 0.0 ? to_eye : source.xyz;
    vec3 between = to_light + to_eye;
    vec3 half_way = source.w != 0.0 ? to_eye : between * inversesqrt(max(dot(between, between), kLeast));
    float cosine = dot(normal, to_light);
    float diffuse = 1.0 + strength * (facing(cosine) - 1.0);
    float shine = pow(clamp(facing(dot(normal, half_way)), 1e-20, 1.0), slices.shininess);
    float specular = strength * slices.specular * shine;
    if (slices.is_two_sided == 0 && cosine <= 0.0) specular = 0.0;
    vec3 color = slices.light_colors[i].rgb * reaching;
    light.diffuse += color * (slices.diffuse * diffuse);
    light.specular += color * specular;
  }
  return light;
}
