// For integrators that keep nothing of a segment's front.

struct Front {
  int nothing;
};

Front front_at(float scalar) { return Front(0); }
