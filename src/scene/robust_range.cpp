#include "src/scene/robust_range.h"

#include <cstddef>

namespace tetravox::scene {
namespace {

constexpr double kTail = 1e-3;        // part of the volume at either end that may be an outlier
constexpr double kOutlierRatio = 20;  // outliers are cut off when they make the range this much wider

/// The part of `range` that holds all but a tail at either end, in whole bins.
ValueRange without_tails(const ValueRange& range, const std::vector<double>& counts) {
  double total = 0.0;
  for (const double count : counts) total += count;
  std::size_t first = 0, last = counts.size() - 1;
  for (double below = counts[first]; first < last && below <= kTail * total; below += counts[++first]) {
  }
  for (double above = counts[last]; last > first && above <= kTail * total; above += counts[--last]) {
  }
  const double width = (range.max - range.min) / static_cast<double>(counts.size());
  return {range.min + width * static_cast<double>(first), range.min + width * static_cast<double>(last + 1)};
}

}  // namespace

ValueRange robust_range(ValueRange range, const CountBins& count) {
  constexpr int kBins = 1024, kLargestZoomCount = 12;
  for (int zoom = 0; zoom < kLargestZoomCount; ++zoom) {
    const ValueRange inner = without_tails(range, count(range, kBins));
    if ((inner.max - inner.min) * kOutlierRatio > range.max - range.min || !(inner.max > inner.min)) break;
    range = inner;
  }
  return range;
}

}  // namespace tetravox::scene
