// For integrators that take a segment at once, and keep nothing of its front.

struct Front {
  Segment segment;
  bool is_pending;
};

Front front_at(float scalar) { return Front(Segment(scalar, scalar, 0.0), false); }
void begin(Segment segment, inout Front front) { front = Front(segment, segment.world_length > 0.0); }
bool is_pending(Front front) { return front.is_pending; }
void integrate_whole(Segment segment, inout vec4 sum);

void advance(inout Front front, inout vec4 sum) {
  integrate_whole(front.segment, sum);
  front.is_pending = false;
}

#define TAKES_WHOLE_SEGMENTS
void integrate(Segment segment, inout Front front, inout vec4 sum) {
  if (segment.world_length > 0.0) integrate_whole(segment, sum);
}
