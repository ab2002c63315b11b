/// Widgets and tables of RGBA -> extinction and colour over a domain.

#include "tetravox/multidimensional.h"

#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox {
namespace {

using Place = std::array<double, 3>;

/// Offset from the centre, in radii, along each of the first `count` axes.
Place offset_in_radii(const Widget& widget, const Place& place, std::size_t count) {
  Place offset{};
  for (std::size_t axis = 0; axis < count; ++axis)
    offset[axis] = (place[axis] - widget.center[axis]) / widget.radius[axis];
  return offset;
}

double square_norm(const Place& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// Of the triangle: 1 along the middle, 0 at a border that lies as far away as the apex does below, and at the whole
/// radius at the upper end.
double eval_triangle(Place offset, std::size_t count) {
  const double height = 0.5 * (offset[count - 1] + 1.0);
  if (!(height > 0.0 && height <= 1.0)) return 0.0;
  offset[count - 1] = 0.0;
  return std::max(0.0, 1.0 - std::sqrt(square_norm(offset)) / height);
}

double eval_shape(WidgetShape shape, const Place& offset, std::size_t count) {
  switch (shape) {
    case WidgetShape::kRectangle:
      return std::all_of(offset.begin(), offset.end(), [](double along) { return std::abs(along) <= 1.0; }) ? 1.0 : 0.0;
    case WidgetShape::kTriangle:
      return eval_triangle(offset, count);
    case WidgetShape::kGaussian:
      return std::exp(-square_norm(offset));
  }
  return 0.0;
}

/// Optical depth of the unit distance.
double depth_of_opacity(double opacity) { return -std::log1p(-std::min(opacity, kLargestOpacity)); }

OpticalPoint eval_widgets(const std::vector<Widget>& widgets, const Place& place, std::size_t count,
                          double unit_distance) {
  OpticalPoint sum;
  const Widget* nearest = nullptr;
  double nearest_square = std::numeric_limits<double>::infinity();
  for (const Widget& widget : widgets) {
    const Place offset = offset_in_radii(widget, place, count);
    if (const double square = square_norm(offset); !nearest || square < nearest_square) {
      nearest = &widget;
      nearest_square = square;
    }
    const double extinction =
        depth_of_opacity(widget.opacity * eval_shape(widget.shape, offset, count)) / unit_distance;
    sum.extinction += extinction;
    for (std::size_t i = 0; i < 3; ++i) sum.color[i] += extinction * widget.color[i];
  }
  if (sum.extinction > 0.0)
    for (double& channel : sum.color) channel = std::min(channel / sum.extinction, 1.0);
  else if (nearest)
    sum.color = nearest->color;  // what is interpolated towards must not be black
  return sum;
}

ValueRange choose_range(const Variable& variable, const ValueRange& occurring) {
  if (variable.range) return *variable.range;
  if (occurring.min < occurring.max) return occurring;
  const double half = std::max(0.5, 1e-3 * std::abs(occurring.min));
  return {occurring.min - half, occurring.min + half};
}

double choose_unit_distance(const MultidimensionalFunction& function, double default_unit_distance) {
  const double distance = function.unit_distance.value_or(default_unit_distance);
  if (!(std::isfinite(distance) && distance > 0.0 && std::isfinite(depth_of_opacity(1.0) / distance)))
    throw Error(ErrorCode::kInvalidArgument, "the unit distance must be a finite number above 0");
  return distance;
}

/// A table without entries: variables with ranges.
OpticalTable make_empty_table(const MultidimensionalFunction& function, std::span<const ValueRange> ranges) {
  if (ranges.size() != function.variables.size())
    throw Error(ErrorCode::kInvalidArgument, "a function of " + std::to_string(function.variables.size()) +
                                                 " variables was given " + std::to_string(ranges.size()) + " ranges");
  OpticalTable table;
  table.variables = function.variables;
  for (std::size_t i = 0; i < ranges.size(); ++i)
    table.variables[i].range = choose_range(table.variables[i], ranges[i]);
  return table;
}

}  // namespace

OpticalTable make_optical_table(const MultidimensionalFunction& function, std::span<const ValueRange> ranges,
                                double default_unit_distance) {
  validate_multidimensional(function);
  if (function.widgets.empty())
    throw Error(ErrorCode::kInvalidArgument, "a function of several variables without widgets; give at least one");
  const double unit_distance = choose_unit_distance(function, default_unit_distance);
  OpticalTable table = make_empty_table(function, ranges);
  const std::size_t count = table.variables.size();
  const auto resolution = static_cast<std::size_t>(function.resolution);
  table.sizes.assign(count, resolution);
  std::size_t size = 1;
  for (const std::size_t along : table.sizes) size *= along;
  table.entries.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    Place place{};
    std::size_t rest = i;
    for (std::size_t axis = 0; axis < count; ++axis, rest /= resolution) {
      const ValueRange& range = *table.variables[axis].range;
      place[axis] =
          std::lerp(range.min, range.max, static_cast<double>(rest % resolution) / static_cast<double>(resolution - 1));
    }
    table.entries.push_back(eval_widgets(function.widgets, place, count, unit_distance));
  }
  validate_optical_table(table);
  return table;
}

OpticalTable make_optical_table(const MultidimensionalFunction& function, std::span<const ValueRange> ranges,
                                double default_unit_distance, std::span<const std::size_t> sizes,
                                std::span<const float> rgba) {
  validate_multidimensional(function);
  const double unit_distance = choose_unit_distance(function, default_unit_distance);
  OpticalTable table = make_empty_table(function, ranges);
  table.sizes.assign(sizes.begin(), sizes.end());
  table.entries.reserve(rgba.size() / 4);
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    for (std::size_t channel = 0; channel < 4; ++channel)
      if (!(rgba[i + channel] >= 0.0f && rgba[i + channel] <= 1.0f))
        throw Error(ErrorCode::kInvalidArgument,
                    "entry " + std::to_string(i / 4) + " of the table: colours and opacities lie in [0, 1]");
    table.entries.push_back({0.0, depth_of_opacity(rgba[i + 3]) / unit_distance, {rgba[i], rgba[i + 1], rgba[i + 2]}});
  }
  validate_optical_table(table);
  return table;
}

OpticalPoint eval_optical_table(const OpticalTable& table, std::span<const double> place) {
  const std::size_t count = table.variables.size();
  std::array<std::size_t, 3> node{};
  Place t{};
  for (std::size_t axis = 0; axis < count; ++axis) {
    const ValueRange& range = *table.variables[axis].range;
    const auto last = static_cast<double>(table.sizes[axis] - 1);
    const double at = std::clamp((place[axis] - range.min) / (range.max - range.min) * last, 0.0, last);
    node[axis] = std::min(static_cast<std::size_t>(at), table.sizes[axis] - 2);
    t[axis] = at - static_cast<double>(node[axis]);
  }
  OpticalPoint sum;
  for (std::size_t corner = 0; corner < std::size_t{1} << count; ++corner) {
    double weight = 1.0;
    std::size_t index = 0, stride = 1;
    for (std::size_t axis = 0; axis < count; ++axis) {
      const std::size_t step = corner >> axis & 1;
      weight *= step ? t[axis] : 1.0 - t[axis];
      index += (node[axis] + step) * stride;
      stride *= table.sizes[axis];
    }
    const OpticalPoint& entry = table.entries[index];
    sum.extinction += weight * entry.extinction;
    for (std::size_t i = 0; i < 3; ++i) sum.color[i] += weight * entry.color[i];
  }
  return sum;
}

}  // namespace tetravox
