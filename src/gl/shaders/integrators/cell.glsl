// Cell data: one value a segment, exact.

#include "integrators/control_points.glsl"
#include "integrators/without_front.glsl"

void integrate(Segment segment, inout Front front, inout vec4 sum) {
  composite_uniform(eval_optics(segment.scalar_back), segment.world_length, sum);
}
