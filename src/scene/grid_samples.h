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

/// Stored scalars of what surrounds the objects. An end beyond which there is next to nothing is open: infinite.
struct Background {
  float low = 0.0f, high = 0.0f;

  bool holds(float value) const { return value >= low && value <= high; }
};

/// The background, where there is one: at least half of the border lies in a narrow interval (the shortest half,
/// Rousseeuw and Leroy 1988); it reaches from there to where the histogram has fallen to a valley or to nothing.
std::optional<Background> find_background(const GridSamples& samples);

}  // namespace tetravox::scene
