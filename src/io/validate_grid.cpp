#include "src/io/validate_grid.h"

#include "tetravox/error.h"

#include <algorithm>
#include <cmath>

namespace tetravox::io {

namespace {

/// Columns that span less than this part of the box of their lengths lie in a plane.
constexpr double kFlattest = 1e-9;

constexpr std::array<const char*, 3> kAxes{"i", "j", "k"};

[[noreturn]] void fail(const std::string& file, const std::string& what) {
  throw Error(ErrorCode::kBadFile, "'" + file + "': " + what + "; the file is damaged, write it again");
}

bool is_spacing(double value) { return std::isfinite(value) && value > 0.0; }

void validate_axis(const GridShape& shape, std::size_t axis, const std::string& file) {
  const std::string place = std::string("axis ") + kAxes[axis] + " of the grid: ";
  if (!std::isfinite(shape.origin[axis])) fail(file, "the origin of the grid is not finite");
  if (!is_spacing(shape.spacing[axis])) fail(file, place + "the spacing is not a positive number");
  const std::vector<double>& values = shape.coordinates[axis];
  if (values.empty()) return;
  if (values.size() != shape.dimensions[axis])
    fail(file, place + std::to_string(values.size()) + " coordinates for " + std::to_string(shape.dimensions[axis]) +
                   " points");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) fail(file, place + "coordinate " + std::to_string(i) + " is not finite");
    if (i > 0 && !(values[i] > values[i - 1]))
      fail(file, place + "coordinate " + std::to_string(i) + " does not ascend");
  }
}

}  // namespace

bool is_invertible(const std::array<double, 9>& m) {
  for (const double value : m)
    if (!std::isfinite(value)) return false;
  std::array<double, 9> unit = m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = std::hypot(m[axis], m[3 + axis], m[6 + axis]);
    if (!is_spacing(length)) return false;
    for (std::size_t row = 0; row < 3; ++row) unit[3 * row + axis] /= length;
  }
  const auto& u = unit;
  const double box =
      u[0] * (u[4] * u[8] - u[5] * u[7]) - u[1] * (u[3] * u[8] - u[5] * u[6]) + u[2] * (u[3] * u[7] - u[4] * u[6]);
  return std::abs(box) > kFlattest;
}

void validate_grid_shape(const GridShape& shape, const std::string& file) {
  const auto& points = shape.dimensions;
  if (*std::min_element(points.begin(), points.end()) < 2)
    throw Error(ErrorCode::kNothingToDraw, "'" + file + "' holds a grid of " + std::to_string(points[0]) + " x " +
                                               std::to_string(points[1]) + " x " + std::to_string(points[2]) +
                                               " points, which has no volume: a grid needs two points or more along "
                                               "each axis");
  for (std::size_t axis = 0; axis < 3; ++axis) validate_axis(shape, axis, file);
  if (!is_invertible(shape.direction)) fail(file, "the direction of the grid cannot be inverted");
}

void validate_grid(const GridData& grid, const std::string& file) {
  validate_grid_shape(grid.shape, file);
  if (grid.components < 1 || grid.components > 4 || grid.component < kMagnitude || grid.component >= grid.components)
    fail(file,
         "component " + std::to_string(grid.component) + " of " + std::to_string(grid.components) + " makes no sense");
  std::uint64_t bytes = static_cast<std::uint64_t>(grid.components) * scalar_type_size(grid.type);
  for (const std::size_t count : grid.value_dimensions())
    if (__builtin_mul_overflow(bytes, std::uint64_t{count}, &bytes)) fail(file, "its dimensions make no sense");
  if (bytes != grid.values.size())
    fail(file, "array '" + grid.array_name + "' has " + std::to_string(grid.values.size()) + " bytes instead of " +
                   std::to_string(bytes));
}

void mend_orientation(GridShape& shape, std::vector<std::string>& notes) {
  bool is_mended = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double& spacing = shape.spacing[axis];
    if (is_spacing(-spacing)) {
      spacing = -spacing;
      for (std::size_t row = 0; row < 3; ++row) shape.direction[3 * row + axis] *= -1.0;
    }
    if (!is_spacing(spacing)) {
      spacing = 1.0;
      is_mended = true;
    }
  }
  if (is_mended) notes.emplace_back("a spacing that is zero or not finite is taken as 1");
  if (!is_invertible(shape.direction)) {
    shape.direction = GridShape{}.direction;
    notes.emplace_back("the direction cannot be inverted and is taken as the identity");
  }
  const bool has_origin =
      std::all_of(shape.origin.begin(), shape.origin.end(), [](double x) { return std::isfinite(x); });
  if (!has_origin) {
    shape.origin = {};
    notes.emplace_back("the origin is not finite and is taken as 0");
  }
}

}  // namespace tetravox::io
