// Gradients of the filtered slices on both sides, linear in between. In grid coordinates.

vec3 gradient_between(Path path, Sample front, Sample back, float share) {
  return mix(front.gradient, back.gradient, share);
}
