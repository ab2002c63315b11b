#pragma once

/// Where a grid lies: grid coordinates count cells, u = (i, j, k) at lattice point (i, j, k).

#include "tetravox/dataset.h"

#include <array>

namespace tetravox::grid {

using Point = std::array<double, 3>;

/// world = origin + world_from_grid * u, u in grid coordinates.
struct GridFrame {
  Point origin{};
  std::array<double, 9> world_from_grid{};  ///< row major
  std::array<double, 9> grid_from_world{};
};

GridFrame make_grid_frame(const GridShape& shape);

/// Bounds of the lattice's corners, world units.
std::array<ValueRange, 3> bounds_of(const GridShape& shape);

/// @throws Error (kInvalidArgument, kNothingToDraw) for a shape or values that make no sense: says what.
void validate_grid(const GridData& grid);

}  // namespace tetravox::grid
