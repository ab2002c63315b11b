// Post-classification: samples in the middles of equal pieces of each segment, some of them at a time; for comparison.

#include "integrators/control_points.glsl"

const int kSamplesAPiece = 16;

struct Front {
  Segment segment;
  int next_sample;
};

Front front_at(float scalar) { return Front(Segment(scalar, scalar, 0.0), tables.samples); }
void begin(Segment segment, inout Front front) {
  front = Front(segment, segment.world_length > 0.0 ? 0 : tables.samples);
}
bool is_pending(Front front) { return front.next_sample < tables.samples; }

void advance(inout Front front, inout vec4 sum) {
  Segment segment = front.segment;
  float share = 1.0 / float(tables.samples);
  int end = min(front.next_sample + kSamplesAPiece, tables.samples);
  for (int i = front.next_sample; i < end; ++i) {
    float scalar = mix(segment.scalar_front, segment.scalar_back, (float(i) + 0.5) * share);
    composite_uniform(eval_optics(scalar), segment.world_length * share, sum);
  }
  front.next_sample = end;
}

#include "integrators/integrate.glsl"
