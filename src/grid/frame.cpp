#include "src/grid/frame.h"

#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace tetravox::grid {
namespace {

double determinant(const std::array<double, 9>& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

std::array<double, 9> inverse(const std::array<double, 9>& m) {
  const double d = 1.0 / determinant(m);
  return {(m[4] * m[8] - m[5] * m[7]) * d, (m[2] * m[7] - m[1] * m[8]) * d, (m[1] * m[5] - m[2] * m[4]) * d,
          (m[5] * m[6] - m[3] * m[8]) * d, (m[0] * m[8] - m[2] * m[6]) * d, (m[2] * m[3] - m[0] * m[5]) * d,
          (m[3] * m[7] - m[4] * m[6]) * d, (m[1] * m[6] - m[0] * m[7]) * d, (m[0] * m[4] - m[1] * m[3]) * d};
}

[[noreturn]] void fail(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, "the grid " + message); }

void validate_shape(const GridShape& shape) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = "along axis " + std::to_string(axis);
    if (shape.dimensions[axis] < 2)
      throw Error(ErrorCode::kNothingToDraw, "the grid has " + std::to_string(shape.dimensions[axis]) + " points " +
                                                 name + ": it has no volume; at least 2 are needed");
    if (!(shape.spacing[axis] > 0.0) || !std::isfinite(shape.spacing[axis]))
      fail("has a spacing " + name + " that is not a positive number");
    if (!std::isfinite(shape.origin[axis])) fail("has an origin that is not finite");
    const std::vector<double>& coordinates = shape.coordinates[axis];
    if (!coordinates.empty() && coordinates.size() != shape.dimensions[axis])
      fail("has " + std::to_string(coordinates.size()) + " coordinates " + name + " for " +
           std::to_string(shape.dimensions[axis]) + " points");
    for (std::size_t i = 0; i < coordinates.size(); ++i)
      if (!std::isfinite(coordinates[i]) || (i > 0 && !(coordinates[i] > coordinates[i - 1])))
        fail("has coordinates " + name + " that do not ascend, at point " + std::to_string(i));
  }
  for (const double element : shape.direction)
    if (!std::isfinite(element)) fail("has a direction matrix that is not finite");
  if (!(std::abs(determinant(shape.direction)) > 1e-12)) fail("has a direction matrix that cannot be inverted");
}

}  // namespace

GridFrame make_grid_frame(const GridShape& shape) {
  GridFrame frame;
  frame.origin = shape.origin;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& coordinates = shape.coordinates[axis];
    double spacing = shape.spacing[axis];
    if (!coordinates.empty()) {
      const double first = coordinates.front();
      spacing = (coordinates.back() - first) / static_cast<double>(coordinates.size() - 1);
      for (const double at : coordinates) frame.planes[axis].push_back(static_cast<float>((at - first) / spacing));
      for (int row = 0; row < 3; ++row) frame.origin[row] += shape.direction[3 * row + axis] * first;
    }
    for (int row = 0; row < 3; ++row) frame.world_from_grid[3 * row + axis] = shape.direction[3 * row + axis] * spacing;
  }
  frame.grid_from_world = inverse(frame.world_from_grid);
  return frame;
}

double mean_spacing(const GridFrame& frame) {
  const auto& m = frame.world_from_grid;
  return std::cbrt(std::abs(m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                            m[2] * (m[3] * m[7] - m[4] * m[6])));
}

double longest_cell_diagonal(const GridFrame& frame) {
  std::array<double, 3> sides{1.0, 1.0, 1.0};  // of the largest cell, grid coordinates
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float>& planes = frame.planes[axis];
    for (std::size_t i = 0; i + 1 < planes.size(); ++i)
      sides[axis] = std::max(i == 0 ? 0.0 : sides[axis], static_cast<double>(planes[i + 1]) - planes[i]);
  }
  double longest = 0.0;
  for (const double y : {-1.0, 1.0})
    for (const double z : {-1.0, 1.0}) {
      const auto& m = frame.world_from_grid;
      const auto along = [&](int row) {
        return m[3 * row] * sides[0] + m[3 * row + 1] * y * sides[1] + m[3 * row + 2] * z * sides[2];
      };
      longest = std::max(longest, std::hypot(along(0), along(1), along(2)));
    }
  return longest;
}

std::array<ValueRange, 3> bounds_of(const GridShape& shape) {
  const GridFrame frame = make_grid_frame(shape);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<ValueRange, 3> bounds;
  bounds.fill({kInfinity, -kInfinity});
  for (int corner = 0; corner < 8; ++corner)
    for (int row = 0; row < 3; ++row) {
      double at = frame.origin[row];
      for (int axis = 0; axis < 3; ++axis)
        if (corner >> axis & 1) at += frame.world_from_grid[3 * row + axis] * (shape.dimensions[axis] - 1.0);
      bounds[row].min = std::min(bounds[row].min, at);
      bounds[row].max = std::max(bounds[row].max, at);
    }
  return bounds;
}

void validate_grid(const GridData& grid) {
  validate_shape(grid.shape);
  if (grid.components < 1 || grid.components > 4) fail("has " + std::to_string(grid.components) + " components");
  if (grid.component != kMagnitude && (grid.component < 0 || grid.component >= grid.components))
    fail("has no component " + std::to_string(grid.component));
  const auto dimensions = grid.value_dimensions();
  const std::size_t wanted = dimensions[0] * dimensions[1] * dimensions[2] * static_cast<std::size_t>(grid.components) *
                             scalar_type_size(grid.type);
  if (grid.values.size() != wanted)
    fail("has " + std::to_string(grid.values.size()) + " bytes of values where its shape needs " +
         std::to_string(wanted));
}

}  // namespace tetravox::grid
