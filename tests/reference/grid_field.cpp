#include "tests/reference/grid_field.h"

#include "tests/reference/kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace tetravox::reference {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

template <class T>
double load_as(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double load_value(ScalarType type, const std::byte* bytes) {
  switch (type) {
    case ScalarType::kInt8:
      return load_as<std::int8_t>(bytes);
    case ScalarType::kUint8:
      return load_as<std::uint8_t>(bytes);
    case ScalarType::kInt16:
      return load_as<std::int16_t>(bytes);
    case ScalarType::kUint16:
      return load_as<std::uint16_t>(bytes);
    case ScalarType::kInt32:
      return load_as<std::int32_t>(bytes);
    case ScalarType::kUint32:
      return load_as<std::uint32_t>(bytes);
    case ScalarType::kInt64:
      return load_as<std::int64_t>(bytes);
    case ScalarType::kUint64:
      return load_as<std::uint64_t>(bytes);
    case ScalarType::kFloat32:
      return load_as<float>(bytes);
    default:
      return load_as<double>(bytes);
  }
}

std::size_t bytes_of(ScalarType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

/// Coordinates of the lattice points along an axis.
std::vector<double> point_positions(const GridShape& shape, int axis) {
  if (!shape.coordinates[axis].empty()) return shape.coordinates[axis];
  std::vector<double> positions(shape.dimensions[axis]);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<double>(i) * shape.spacing[axis];
  return positions;
}

std::vector<double> middles_of(const std::vector<double>& positions) {
  std::vector<double> middles;
  for (std::size_t i = 1; i < positions.size(); ++i) middles.push_back(0.5 * (positions[i - 1] + positions[i]));
  return middles;
}

/// Rows of the inverse of the direction matrix, by Cramer's rule.
std::array<Vec, 3> invert(const std::array<double, 9>& m) {
  const Vec a{m[0], m[3], m[6]}, b{m[1], m[4], m[7]}, c{m[2], m[5], m[8]};  // columns
  const double volume = dot(a, cross(b, c));
  return {1.0 / volume * cross(b, c), 1.0 / volume * cross(c, a), 1.0 / volume * cross(a, b)};
}

/// Solves for the coefficients of one line, from missing value to missing value.
void solve_line(std::vector<double>& line) {
  std::vector<double> run;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && !std::isnan(line[i])) {
      run.push_back(line[i]);
      continue;
    }
    solve_bspline(run);
    std::copy(run.begin(), run.end(), line.begin() + static_cast<std::ptrdiff_t>(i - run.size()));
    run.clear();
  }
}

}  // namespace

Lattice make_lattice(const GridData& grid, const Filter& filter) {
  Lattice lattice;
  lattice.filter = filter;
  lattice.origin = grid.shape.origin;
  lattice.lattice_from_world = invert(grid.shape.direction);
  lattice.counts = grid.value_dimensions();
  const bool is_cell_data = grid.association == Association::kCell;
  lattice.is_constant = filter.kind == FilterKind::kNearest || (is_cell_data && filter.kind == FilterKind::kLinear);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> points = point_positions(grid.shape, axis);
    std::vector<double>& knots = lattice.knots[axis];
    if (is_cell_data == lattice.is_constant) {
      knots = points;
    } else {
      knots = middles_of(points);
      if (is_cell_data) continue;
      knots.insert(knots.begin(), points.front());
      knots.push_back(points.back());
    }
  }
  return lattice;
}

std::vector<double> make_values(const GridData& grid) {
  const std::size_t size = bytes_of(grid.type);
  const std::size_t count = grid.values.size() / (size * grid.components);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto component = [&](int k) {
      return load_value(grid.type, grid.values.data() + (i * grid.components + k) * size);
    };
    if (grid.component == kMagnitude) {
      double squares = 0.0;
      for (int k = 0; k < grid.components; ++k) squares += component(k) * component(k);
      values[i] = std::sqrt(squares);
    } else {
      values[i] = component(grid.component);
    }
    if (!std::isfinite(values[i])) values[i] = kMissing;
  }
  return values;
}

std::vector<double> make_coefficients(const Lattice& lattice, std::vector<double> values) {
  if (lattice.filter.kind != FilterKind::kInterpolatingBspline) return values;
  const std::array<std::size_t, 3> strides{1, lattice.counts[0], lattice.counts[0] * lattice.counts[1]};
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t count = lattice.counts[axis], stride = strides[axis];
    std::vector<double> line(count);
    for (std::size_t start = 0; start < values.size(); ++start) {
      if (start / stride % count != 0) continue;
      for (std::size_t i = 0; i < count; ++i) line[i] = values[start + i * stride];
      solve_line(line);
      for (std::size_t i = 0; i < count; ++i) values[start + i * stride] = line[i];
    }
  }
  return values;
}

CellField::CellField(const Lattice& lattice) : lattice_(lattice) {
  width_ = lattice.is_constant ? 1 : 2 * kernel_radius(lattice.filter);
  block_.resize(static_cast<std::size_t>(width_) * width_ * width_);
}

std::size_t CellField::index_beyond_border(int axis, std::ptrdiff_t index) const {
  const auto last = static_cast<std::ptrdiff_t>(lattice_.counts[axis]) - 1;
  if (lattice_.filter.kind == FilterKind::kInterpolatingBspline) {
    if (last == 0) return 0;
    while (index < 0 || index > last) index = index < 0 ? -index : 2 * last - index;
  }
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(index, 0, last));
}

bool CellField::load(const std::vector<double>& coefficients, const CellIndex& cell) {
  low_ = std::numeric_limits<double>::infinity();
  high_ = -low_;
  const int before = lattice_.is_constant ? 0 : width_ / 2 - 1;
  double* out = block_.data();
  const auto index = [&](int axis, int offset) {
    return index_beyond_border(axis, static_cast<std::ptrdiff_t>(cell[axis]) + offset - before);
  };
  for (int k = 0; k < width_; ++k) {
    for (int j = 0; j < width_; ++j) {
      const std::size_t row = lattice_.counts[0] * (index(1, j) + lattice_.counts[1] * index(2, k));
      for (int i = 0; i < width_; ++i) {
        *out = coefficients[row + index(0, i)];
        if (std::isnan(*out)) return false;
        low_ = std::min(low_, *out);
        high_ = std::max(high_, *out);
        ++out;
      }
    }
  }
  return true;
}

double CellField::eval(const Vec& fraction) const {
  if (is_flat()) return low_;
  std::array<std::array<double, 16>, 3> weights;
  for (int axis = 0; axis < 3; ++axis) make_weights(lattice_.filter, fraction[axis], weights[axis].data());
  double sum = 0.0;
  const double* value = block_.data();
  for (int k = 0; k < width_; ++k) {
    for (int j = 0; j < width_; ++j) {
      double row = 0.0;
      for (int i = 0; i < width_; ++i) row += weights[0][i] * *value++;
      sum += weights[2][k] * weights[1][j] * row;
    }
  }
  return sum;
}

}  // namespace tetravox::reference
