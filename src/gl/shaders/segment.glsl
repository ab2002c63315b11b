// What sources hand to integrators, and what both add to.

struct Segment {
  float scalar_front;  // stored scalars
  float scalar_back;
  float world_length;        // world
};

// Premultiplied colour so far, and transmittance, of one ray.
const vec4 kNothingYet = vec4(0.0, 0.0, 0.0, 1.0);

// (1 - exp(-x)) / x for x >= 0: the series where the difference would cancel, to 2e-6.
float absorbed_ratio(float x) {
  if (x > 0.25) return (1.0 - exp(-x)) / x;
  return 1.0 + x * (-0.5 + x * (1.0 / 6.0 + x * (-1.0 / 24.0 + x * (1.0 / 120.0))));
}

// Adds a piece whose emission is spread like its extinction; `emission`: colour times optical depth.
void composite_piece(float depth, vec3 emission, inout vec4 sum) {
  float visible = sum.a * absorbed_ratio(depth);
  sum.rgb += visible * emission;
  sum.a -= visible * depth;
}

// Whether no 8-bit pixel can change any more, whatever follows and over any background.
bool is_settled(vec4 sum) {
  const float kDim = 1e-4;
  if (sum.a >= kDim) return false;
  vec3 low = floor((sum.rgb - 1e-6) * 255.0 + 0.5), high = floor((sum.rgb + 3.0 * sum.a + 1e-6) * 255.0 + 0.5);
  return low == high;
}
