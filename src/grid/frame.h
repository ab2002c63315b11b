#pragma once

/// Where a grid lies. Grid coordinates count cells: u = (i, j, k) at lattice point (i, j, k) where the axes are even.
/// Along an uneven axis they are proportional to the distance, from 0 at the first point to dimension - 1 at the last.

#include "tetravox/dataset.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::grid {

using Point = std::array<double, 3>;

/// world = origin + world_from_grid * u, u in grid coordinates.
struct GridFrame {
  Point origin{};
  std::array<double, 9> world_from_grid{};  ///< row major
  std::array<double, 9> grid_from_world{};
  std::array<std::vector<float>, 3> planes;  ///< uneven axes: grid coordinate of each lattice plane; else empty

  /// Grid coordinate of lattice plane `index`.
  float plane(int axis, std::int64_t index) const {
    return planes[axis].empty() ? static_cast<float>(index) : planes[axis][static_cast<std::size_t>(index)];
  }
};

GridFrame make_grid_frame(const GridShape& shape);

/// World length of a voxel: of the cube with its volume.
double mean_spacing(const GridFrame& frame);

/// World length of the longest diagonal of a cell.
double longest_cell_diagonal(const GridFrame& frame);

/// Bounds of the lattice's corners, world units.
std::array<ValueRange, 3> bounds_of(const GridShape& shape);

/// @throws Error (kInvalidArgument, kNothingToDraw) for a shape or values that make no sense: says what.
void validate_grid(const GridData& grid);

}  // namespace tetravox::grid
