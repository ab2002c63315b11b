#pragma once

/// Interpolation of tables of four numbers, in float: what textures do, and what the kernels do after them.

#include "src/optics/pair_integrals.h"
#include "src/optics/segment_domain.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace tetravox::optics {

/// Between entry `index` and the next.
struct Node {
  std::size_t index = 0;
  float part = 0.0f;
};

/// `place` in [0, 1] among `count` entries.
inline Node find_node(float place, int count) {
  const float at = place * static_cast<float>(count - 1);
  const int index = std::clamp(static_cast<int>(at), 0, count - 2);
  return {static_cast<std::size_t>(index), at - static_cast<float>(index)};
}

using FloatRecord = std::array<float, 4>;

inline FloatRecord mix(float t, const FloatRecord& a, const FloatRecord& b) {
  FloatRecord mixed;
  for (std::size_t i = 0; i < 4; ++i) mixed[i] = t * (b[i] - a[i]) + a[i];
  return mixed;
}

/// Bilinear among records `first`, `first + 1`, `first + row`, `first + row + 1`.
inline FloatRecord mix_square(const float* records, std::size_t first, std::size_t row, float x, float y) {
  const auto load = [&](std::size_t index) {
    const float* r = records + 4 * index;
    return FloatRecord{r[0], r[1], r[2], r[3]};
  };
  return mix(y, mix(x, load(first), load(first + 1)), mix(x, load(first + row), load(first + row + 1)));
}

/// What a table holds, times the opacity bound.
inline SegmentColor unfold(const FloatRecord& quotient, float bound) {
  return {quotient[0] * bound, quotient[1] * bound, quotient[2] * bound, quotient[3] * bound};
}

/// Writes a slab divided by the opacity bound.
inline void store_quotient(const Slab& slab, double bound, int bits, float* entry) {
  const double inverse = bound > 0.0 ? 1.0 / bound : 0.0;
  for (std::size_t i = 0; i < 3; ++i) entry[i] = store_in_bits(slab.color[i] * inverse, bits);
  entry[3] = store_in_bits(slab.opacity * inverse, bits);
}

}  // namespace tetravox::optics
