// The light's buffer: how much of the light comes to a slab, and behind it (Kniss, Premoze, Hansen, Ebert 2002).

// Scattered light by colour, and the part of the light that comes straight; that is negative where light misses the box.
layout(binding = 9) uniform sampler2D light_before;
layout(binding = 10) uniform sampler2D light_behind;

vec2 in_buffer(vec3 p) { return vec2(dot(slices.light_x, vec4(p, 1.0)), dot(slices.light_y, vec4(p, 1.0))); }

// Linear between the rays of the light that meet the box: beside it nothing is in shadow, and must not shine in.
vec3 look_up_light(sampler2D light, vec2 at) {
  ivec2 last = textureSize(light, 0) - 1;
  vec2 texel = at * vec2(last + 1) - 0.5;
  ivec2 corner = ivec2(floor(texel));
  vec2 share = texel - vec2(corner);
  vec4 sum = vec4(0.0);
  float total = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1);
    vec4 value = texelFetch(light, clamp(corner + step, ivec2(0), last), 0);
    float weight = (step.x == 1 ? share.x : 1.0 - share.x) * (step.y == 1 ? share.y : 1.0 - share.y);
    if (value.a < 0.0) weight = 0.0;
    sum += weight * value;
    total += weight;
  }
  sum = total > 1e-6 ? sum / total : vec4(1.0);
  return mix(vec3(sum.a), sum.rgb, slices.translucency);
}

// Depths grow evenly on the light's own way through what the slab holds of the box.
vec3 light_between(vec3 p, int slab) {
  const vec3 kLeast = vec3(1e-30);
  vec2 at = in_buffer(p);
  vec3 before = look_up_light(light_before, at), behind = look_up_light(light_behind, at);
  vec2 span = span_in_slab(make_path(p, slices.light_z.xyz, -1e30, frame.world_per_local), slab);
  float share = clamp(-span.x / max(span.y - span.x, 1e-20), 0.0, 1.0);
  return max(before, kLeast) * pow(max(behind, kLeast) / max(before, kLeast), vec3(share));
}
