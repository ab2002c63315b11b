#pragma once

/// Equal bins over a range of stored scalars, and what the histograms of analysis.h have in common.

#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

namespace tetravox::scene {

/// Equal bins over [range.min, range.max]; the last one holds its end. A range of one value lies in the middle bin.
class Bins {
 public:
  Bins(const ValueRange& range, int count)
      : range_(range), count_(static_cast<std::size_t>(count)), per_value_(count / (range.max - range.min)) {}

  /// The bin that holds a value; nothing outside the range.
  std::optional<std::size_t> bin_of(double value) const {
    if (!(value >= range_.min && value <= range_.max)) return std::nullopt;
    return nearest_bin(value);
  }
  /// The bin that is nearest to a value.
  std::size_t nearest_bin(double value) const {
    if (!(range_.max > range_.min)) return count_ / 2;
    const double last = static_cast<double>(count_) - 1.0;
    return static_cast<std::size_t>(std::clamp((value - range_.min) * per_value_, 0.0, last));
  }
  /// Where a bin begins; bin `count` begins at the end of the range.
  double begin_of(std::size_t bin) const {
    return std::lerp(range_.min, range_.max, static_cast<double>(bin) / static_cast<double>(count_));
  }

 private:
  ValueRange range_;
  std::size_t count_;
  double per_value_;
};

/// @throws Error (kInvalidArgument).
inline void require_bins(int bins, int largest) {
  if (bins < 1 || bins > largest)
    throw Error(ErrorCode::kInvalidArgument,
                "this histogram has from 1 to " + std::to_string(largest) + " bins, not " + std::to_string(bins));
}

/// The range that was asked for, or all that occurs. @throws Error (kInvalidArgument).
inline ValueRange chosen_range(const std::optional<ValueRange>& asked, const ValueRange& all) {
  if (!asked) return all;
  if (!std::isfinite(asked->min) || !std::isfinite(asked->max) || !(asked->min < asked->max))
    throw Error(ErrorCode::kInvalidArgument, "the range of a histogram must be two finite numbers, the smaller first");
  return *asked;
}

/// A range of values as stored scalars of `prepared`, a mesh or a grid.
template <class Prepared>
ValueRange stored_range(const Prepared& prepared, const ValueRange& values) {
  // What is stored is rounded to float: the ends of the data must not fall outside.
  const auto stored = [&](double value) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    const double exact = (value - prepared.scalar_offset) / prepared.scalar_scale;
    return static_cast<double>(static_cast<float>(std::clamp(exact, -kLargest, kLargest)));
  };
  return {stored(values.min), stored(values.max)};
}

}  // namespace tetravox::scene
