// What each ray passes of a slab, blended with what lies before it.
//
// LIT, SURFACES, HALF_ANGLE, STRIPES: what there is.

#include "slice.glsl"
#include "slice_field.glsl"
#include "slice_classify.glsl"

#ifdef LIT
#include "slice_shading.glsl"
#include "slice_gradient.glsl"
#endif
#ifdef SURFACES
#include "slice_surfaces.glsl"
#endif
#ifdef HALF_ANGLE
#include "slice_light.glsl"
layout(location = 0) uniform float side;  // 1: rays that go the light's way, -1: those that come towards it
#endif

flat in ivec2 piece;
layout(location = 0) out vec4 color;

vec2 span_in_piece(Path path) {
  vec2 span = span_in_slab(path, piece.x);
#ifdef STRIPES
  float low = slices.lower[slices.stack_axis] + float(piece.y);
  span = cut_span(span, path.grid_base[slices.stack_axis], path.grid_step[slices.stack_axis], low, low + 1.0);
#endif
  return span;
}

#ifdef LIT
Illumination light_at(Path path, Sample front, Sample back, bool is_surface, float share) {
  float z = mix(front.z, back.z, share);
  vec3 reaching = vec3(1.0);
#ifdef HALF_ANGLE
  reaching = light_between(path.base + z * path.direction, piece.x);
#endif
  vec3 gradient = camera_gradient(gradient_between(path, front, back, share));
  return illuminate(gradient, -normalize(path.direction), is_surface, reaching);
}
#endif

// The volume between two samples.
void add_volume(Path path, Sample front, Sample back, inout vec4 sum) {
  if (!(front.z < back.z)) return;
#ifdef LIT
  vec4 part = vec4(0.0, 0.0, 0.0, sum.a);
  classify(path, front, back, piece.y, part);
  Illumination light = light_at(path, front, back, false, 0.5);
  sum.rgb += part.rgb * light.diffuse + (sum.a - part.a) * light.specular;
  sum.a = part.a;
#else
  classify(path, front, back, piece.y, sum);
#endif
}

#ifdef SURFACES
void add_slab(Path path, Sample front, Sample back, inout vec4 sum) {
  int below_front = count_below(front.scalar), below_back = count_below(back.scalar);
  bool is_met = below_front != below_back;
  float value = first_value(below_front, below_back);
  float share = is_met ? clamp((value - front.scalar) / (back.scalar - front.scalar), 0.0, 1.0) : 1.0;
  Sample met = between(front, back, share, is_met ? value : back.scalar);
  add_volume(path, front, met, sum);
  if (!is_met) return;
  vec4 seen = texelFetch(surface_colors, ivec2(below_front, below_back), 0);
#ifdef LIT
  Illumination light = light_at(path, front, back, true, share);
  seen.rgb = seen.rgb * light.diffuse + seen.a * light.specular;
#endif
  sum.rgb += sum.a * seen.rgb;
  sum.a -= sum.a * seen.a;
  add_volume(path, met, back, sum);
}
#else
void add_slab(Path path, Sample front, Sample back, inout vec4 sum) { add_volume(path, front, back, sum); }
#endif

void main() {
  Path path = path_of_pixel(ivec2(gl_FragCoord.xy));
  vec2 span = span_in_piece(path);
  if (!(span.x < span.y)) discard;
#ifdef HALF_ANGLE
  if (path.t_step * side <= 0.0) discard;
#endif
  Sample front = front_sample(path, span.x, piece.y), back = back_sample(path, span.y, piece.y);
  if (is_missing(front) || is_missing(back)) discard;
  vec4 sum = kNothingYet;
  add_slab(path, front, back, sum);
  color = vec4(sum.rgb, 1.0 - sum.a);
}
