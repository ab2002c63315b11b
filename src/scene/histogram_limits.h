#pragma once

/// What histograms of meshes and grids have in common.

#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace tetravox::scene {

/// @throws Error (kInvalidArgument) for a number of bins out of range.
inline void require_bin_count(int bins) {
  if (bins < 1 || bins > 1 << 20) throw Error(ErrorCode::kInvalidArgument, "a histogram has from 1 to 1048576 bins");
}

inline double diagonal_of(const std::array<ValueRange, 3>& bounds) {
  return std::hypot(bounds[0].max - bounds[0].min, bounds[1].max - bounds[1].min, bounds[2].max - bounds[2].min);
}

/// Unit distance for which a body's mean chord (world length) is as many units long as that of a cube with a diagonal
/// of 100. Empty where the bounds have no size.
inline std::optional<double> unit_distance_for_chord(double chord, const std::array<ValueRange, 3>& bounds) {
  constexpr double kChordOfCube = 38.49;  // hundredths of the diagonal: 2 / (3 sqrt(3))
  constexpr double kSmallest = 1.0 / 20, kLargest = 1.5;
  const double unit = diagonal_of(bounds) / 100.0;
  if (!(unit > 0.0)) return std::nullopt;
  return std::clamp(chord / kChordOfCube, kSmallest * unit, kLargest * unit);
}

}  // namespace tetravox::scene
