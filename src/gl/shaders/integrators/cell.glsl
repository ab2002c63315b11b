// Cell data: one value a segment, exact.

#include "integrators/control_points.glsl"
#include "integrators/whole_segments.glsl"

void integrate_whole(Segment segment, inout vec4 sum) {
  composite_uniform(eval_optics(segment.scalar_back), segment.world_length, sum);
}
