// Pre-integrated (Engel, Kraus, Ertl 2001): the slab from its two scalars.

struct Sample {
  float z;
  float scalar;
};

Sample sample_at(Path path, float z, int layer) {
  return Sample(z, interpolate(corners_at(place_at(path, z), layer)));
}
Sample front_sample(Path path, float z, int layer) { return sample_at(path, z, layer); }
Sample back_sample(Path path, float z, int layer) { return sample_at(path, z, layer); }
Sample between(Sample front, Sample back, float share, float scalar) {
  return Sample(mix(front.z, back.z, share), scalar);
}
bool is_missing(Sample s) { return isnan(s.scalar); }

#ifdef CURVED
// How far the field is off the chord in the middle of the slab.
float bend_between(Path path, Sample front, Sample back, int layer) {
  float middle = interpolate(corners_at(place_at(path, 0.5 * (front.z + back.z)), layer));
  return isnan(middle) ? 0.0 : middle - 0.5 * (front.scalar + back.scalar);
}
#endif

#include "slice_segments.glsl"
