// For integrators that keep nothing of a segment's front.

struct Front {
  int nothing;
};

Front front_at(float scalar) { return Front(0); }

void integrate(Segment segment, inout Front front, inout vec4 sum);

// All segments take the same way.
bool integrate_plainly(Segment segment, inout Front front, inout vec4 sum) {
  integrate(segment, front, sum);
  return true;
}
