#pragma once

/// The range of a field without a few outliers.

#include "tetravox/dataset.h"

#include <functional>
#include <vector>

namespace tetravox::scene {

/// Counts of the field in equal bins over a range; values outside count for the outermost bins.
using CountBins = std::function<std::vector<double>(const ValueRange& range, int bins)>;

/// `range` without a few outliers that would press everything else into one bin.
ValueRange robust_range(ValueRange range, const CountBins& count);

}  // namespace tetravox::scene
