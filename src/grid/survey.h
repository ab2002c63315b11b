#pragma once

/// What is known of a grid and its values without holding them.

#include "tetravox/dataset.h"
#include "tetravox/progress.h"

#include <cstdint>

namespace tetravox::grid {

/// Range of the finite values, and how many are not finite. A magnitude counts as one value.
struct ValueSurvey {
  ValueRange range;  ///< min > max where no value is finite
  std::uint64_t missing = 0;
};

/// Of the component to draw. One parallel pass; the same for any number of threads.
ValueSurvey survey_values(const GridData& grid);

/// Of the array that the grid holds: its type, ranges of all components and of the magnitude (0 to 0 where no value is
/// finite). One parallel pass; the same for any number of threads.
/// @throws Error (kCancelled).
ArrayInfo describe_values(const GridData& grid, const Progress& progress = {});

/// Fills in shape, counts, bounds and the one array of a valid grid.
/// @throws Error (kCancelled).
void describe_grid(const GridData& grid, DatasetInfo& info, const Progress& progress = {});

}  // namespace tetravox::grid
