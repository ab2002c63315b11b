// A slab as segments: one, linear between its two scalars, or
//
// CURVED: as many as follow the parabola through a third scalar, in the middle. Slabs meet in the same scalar all the
// same: nothing that the function shows is lost between them.

#include "integrator.glsl"

void classify(Path path, Sample front, Sample back, int layer, inout vec4 sum) {
  float len = max(back.z - front.z, 0.0) * path.world_per_z;
  Front at = front_at(front.scalar);
#ifdef CURVED
  const float kMost = 16.0;
  float bend = bend_between(path, front, back, layer);
  float count = clamp(ceil(sqrt(abs(bend) * slices.segments_per_bend)), 1.0, kMost);
  float scalar = front.scalar;
  for (float i = 1.0; i <= count; i += 1.0) {
    float share = i / count;
    float next = mix(front.scalar, back.scalar, share) + 4.0 * bend * share * (1.0 - share);
    next = i == count ? back.scalar : clamp(next, slices.scalar_low, slices.scalar_high);
    integrate(Segment(scalar, next, len / count), at, sum);
    scalar = next;
  }
#else
  integrate(Segment(front.scalar, back.scalar, len), at, sum);
#endif
}
