#include "src/scene/differential_samples.h"

#include "src/scene/robust_range.h"
#include "src/scene/volume_bins.h"

#include <algorithm>

namespace tetravox::scene {

ValueRange range_of_gradients(const std::vector<DifferentialSample>& samples) {
  float largest = 0.0f;
  for (const DifferentialSample& sample : samples) largest = std::max(largest, sample.gradient);
  const ValueRange all{0.0, largest};
  if (!(largest > 0.0f)) return all;
  const auto count = [&](const ValueRange& range, int bins) {
    std::vector<double> counts(static_cast<std::size_t>(bins));
    const Bins axis(range, bins);
    for (const DifferentialSample& sample : samples) counts[axis.nearest_bin(sample.gradient)] += sample.volume;
    return counts;
  };
  return {0.0, robust_range(all, count).max};
}

}  // namespace tetravox::scene
