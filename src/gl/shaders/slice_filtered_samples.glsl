// Samples at the ends of a slab: of the filtered slices on both sides.

struct Sample {
  float z;
  float scalar;
  vec3 gradient;  // grid coordinates
};

Sample sample_of(float z, bool is_lower) {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 value = is_lower ? texelFetch(lower_slice, pixel, 0) : texelFetch(upper_slice, pixel, 0);
  return Sample(z, value.w, value.xyz);
}
Sample front_sample(Path path, float z, int layer) { return sample_of(z, path.t_step > 0.0); }
Sample back_sample(Path path, float z, int layer) { return sample_of(z, path.t_step <= 0.0); }
Sample between(Sample front, Sample back, float share, float scalar) {
  return Sample(mix(front.z, back.z, share), scalar, mix(front.gradient, back.gradient, share));
}
bool is_missing(Sample s) { return isnan(s.scalar); }
