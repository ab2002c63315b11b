#include "src/cpu/face_bins.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::cpu {
namespace {

constexpr double kMostSquares = 1024.0;  // along a side

/// By what part of a square a face is taken as larger: far more than roundings of projections.
constexpr double kMargin = 1e-6;

}  // namespace

FaceBins::FaceBins(const PreparedMesh& mesh, const Vector3& travel) {
  const ShadowLine line = make_shadow_line({}, travel, 1.0);
  axes_ = line.axes;
  for (std::size_t i = 0; i < 2; ++i) slopes_[i] = line.step[static_cast<std::size_t>(axes_[i])] * line.sign;

  std::vector<std::array<Point, 3>> corners;
  std::vector<std::uint32_t> entered;
  Point upper{};
  lower_.fill(std::numeric_limits<double>::infinity());
  upper.fill(-lower_[0]);
  for (std::size_t i = 0; i < mesh.boundary.size(); ++i) {
    std::array<Point, 3> projected;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& vertex = mesh.vertices[mesh.boundary[i].vertices[k]];
      projected[k] = project({vertex.x, vertex.y, vertex.z});
    }
    const auto [a, b, c] = projected;
    // Clockwise: the light enters. A hair to the other side may be rounding.
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area > 1e-14) continue;
    corners.push_back(projected);
    entered.push_back(static_cast<std::uint32_t>(i));
    for (const Point& p : projected)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        lower_[axis] = std::min(lower_[axis], p[axis]);
        upper[axis] = std::max(upper[axis], p[axis]);
      }
  }
  if (entered.empty()) return;
  side_ = static_cast<std::size_t>(std::clamp(std::sqrt(static_cast<double>(entered.size())), 1.0, kMostSquares));
  for (std::size_t axis = 0; axis < 2; ++axis)
    squares_per_length_[axis] = static_cast<double>(side_) / std::max(upper[axis] - lower_[axis], 1e-30);

  const auto visit_squares = [&](const std::array<Point, 3>& face, const auto& visit) {
    std::array<std::size_t, 2> first{}, last{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto [low, high] =
          std::minmax({square_of(face[0], axis), square_of(face[1], axis), square_of(face[2], axis)});
      const double most = static_cast<double>(side_ - 1);
      first[axis] = static_cast<std::size_t>(std::clamp(low - kMargin, 0.0, most));
      last[axis] = static_cast<std::size_t>(std::clamp(high + kMargin, 0.0, most));
    }
    for (std::size_t row = first[1]; row <= last[1]; ++row)
      for (std::size_t column = first[0]; column <= last[0]; ++column) visit(row * side_ + column);
  };
  std::vector<std::size_t> counts(side_ * side_ + 1);
  for (const auto& face : corners) visit_squares(face, [&](std::size_t square) { ++counts[square + 1]; });
  for (std::size_t i = 1; i < counts.size(); ++i) counts[i] += counts[i - 1];
  starts_ = counts;
  faces_.resize(starts_.back());
  for (std::size_t i = 0; i < corners.size(); ++i)
    visit_squares(corners[i], [&](std::size_t square) { faces_[counts[square]++] = entered[i]; });
}

FaceBins::Point FaceBins::project(const Vector3& local) const {
  const double along = local[static_cast<std::size_t>(axes_[2])];
  return {local[static_cast<std::size_t>(axes_[0])] - slopes_[0] * along,
          local[static_cast<std::size_t>(axes_[1])] - slopes_[1] * along};
}

std::span<const std::uint32_t> FaceBins::faces_at(const Vector3& place) const {
  const Point at = project(place);
  std::size_t square = 0;
  for (const std::size_t axis : {std::size_t{1}, std::size_t{0}}) {
    const double index = square_of(at, axis), side = static_cast<double>(side_);
    if (!(index >= -kMargin && index <= side + kMargin)) return {};
    square = square * side_ + static_cast<std::size_t>(std::clamp(index, 0.0, side - 1.0));
  }
  return {faces_.data() + starts_[square], faces_.data() + starts_[square + 1]};
}

}  // namespace tetravox::cpu
