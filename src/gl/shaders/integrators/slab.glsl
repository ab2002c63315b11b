// Slabs of one thickness (Engel, Kraus, Ertl 2001): colour and opacity from a picture over the scalars behind and in
// front. A segment that is thinner has a part of one.
//
// The picture is not filtered, and looked up anywhere in its texels: scalars are rounded to their middles.

#include "segment.glsl"

#define TAKES_WHOLE_SEGMENTS

layout(binding = 4) uniform sampler2D slabs;  // colour, opacity

struct Front {
  float place;  // in the picture
};

float place_of(float scalar) { return scalar * march.slab_scale + march.slab_offset; }

Front front_at(float scalar) { return Front(place_of(scalar)); }

// The opacity 1 - (1 - a)^f of a part f of a slab, divided by a: the binomial series where the difference would cancel,
// to 2e-4.
float part_of_slab(float f, float a) {
  if (f >= 0.999) return 1.0;
  if (a > 0.25) return (1.0 - pow(max(1.0 - a, 0.0), f)) / a;
  float sum = 1.0 + (4.0 - f) * (1.0 / 5.0) * a;
  sum = 1.0 + (3.0 - f) * (1.0 / 4.0) * a * sum;
  sum = 1.0 + (2.0 - f) * (1.0 / 3.0) * a * sum;
  return f * (1.0 + (1.0 - f) * (1.0 / 2.0) * a * sum);
}

void integrate(Segment segment, inout Front front, inout vec4 sum) {
  float place = place_of(segment.scalar_back);
  vec4 slab = textureLod(slabs, vec2(place, front.place), 0.0);
  slab *= sum.a * part_of_slab(min(segment.world_length / march.sample_distance, 1.0), slab.a);
  sum += vec4(slab.rgb, -slab.a);
  front.place = place;
}
