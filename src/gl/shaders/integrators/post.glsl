// Post-classification: samples in the middles of equal pieces of each segment; for comparison.

#include "integrators/control_points.glsl"
#include "integrators/whole_segments.glsl"

void integrate_whole(Segment segment, inout vec4 sum) {
  float share = 1.0 / float(tables.samples);
  for (int i = 0; i < tables.samples; ++i) {
    float scalar = mix(segment.scalar_front, segment.scalar_back, (float(i) + 0.5) * share);
    composite_uniform(eval_optics(scalar), segment.world_length * share, sum);
  }
}
