#pragma once

/// Values of a grid for statistics of the field, and what surrounds the objects in it.

#include "tetravox/grid.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace tetravox::scene {

/// Stored scalars with the volume around each (in grid coordinates, or of uneven axes).
struct GridSamples {
  std::vector<float> values, weights;  ///< [samples], without missing ones
  std::vector<float> border;           ///< values on the six faces of the grid, evenly, without missing ones; ascending
};

/// All rows of values, or evenly spread ones with about `largest_count` values. Deterministic.
GridSamples sample_grid(const PreparedGrid& grid, std::size_t largest_count);

/// Where the background ends: the stored scalar beyond which values are no longer those around the objects, and on
/// which side of it the background lies.
struct Background {
  float end = 0.0f;
  bool is_low = true;  ///< below `end`; otherwise above
};

/// The background, where there is one: at least half of the border lies in a narrow interval (the shortest half,
/// Rousseeuw and Leroy 1988) at one end of the values, and the histogram falls from there to a valley or to nothing.
std::optional<Background> find_background(const GridSamples& samples);

}  // namespace tetravox::scene
