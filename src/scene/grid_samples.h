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

/// How much space each value has along an axis: half of the distance to either neighbour, or the width of its cell. In
/// cells, or in units of an uneven axis.
std::vector<double> widths_along(const GridData& grid, std::size_t axis);

/// `wanted` of `rows` rows of values, spread evenly, ascending: all, or one of each stratum at a place that shares no
/// period with the grid's (golden ratio). `wanted` in [1, rows].
std::vector<std::size_t> choose_rows(std::size_t rows, std::size_t wanted);

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
