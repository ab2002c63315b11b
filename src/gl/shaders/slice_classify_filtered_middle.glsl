// One sample between two filtered slices: their mean.

#include "segment.glsl"
#include "integrators/tables.glsl"
#include "integrators/control_points.glsl"
#include "slice_filtered_samples.glsl"

void classify(Path path, Sample front, Sample back, int layer, inout vec4 sum) {
  float len = max(back.z - front.z, 0.0) * path.world_per_z;
  composite_uniform(eval_optics(0.5 * (front.scalar + back.scalar)), len, sum);
}
