// Pre-integrated between two filtered slices.

#include "slice_filtered_samples.glsl"

#ifdef CURVED
// How far the cubic through both scalars, with the slopes of both gradients, is off the chord in the middle.
float bend_between(Path path, Sample front, Sample back, int layer) {
  float change = dot(front.gradient - back.gradient, path.grid_step);
  return 0.125 * (back.z - front.z) * change;
}
#endif

#include "slice_segments.glsl"
