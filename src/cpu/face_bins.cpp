#include "src/cpu/face_bins.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::cpu {
namespace {

constexpr double kMostSquares = 1024.0;  // along a side

/// Squares that hold a face, in the mean: faces that are long and askew would be in all of them.
constexpr std::size_t kMostEntries = 16;

/// By what part of a square a face is taken as larger: far more than roundings of projections.
constexpr double kMargin = 1e-6;

}  // namespace

FaceBins::FaceBins(const PreparedMesh& mesh, const Vector3& travel) {
  const ShadowLine line = make_shadow_line({}, travel, 1.0);
  axes_ = line.axes;
  for (std::size_t i = 0; i < 2; ++i) slopes_[i] = line.step[static_cast<std::size_t>(axes_[i])] * line.sign;
  Point upper{};
  const std::vector<Projected> faces = project_entered(mesh, upper);
  if (faces.empty()) return;
  std::vector<std::size_t> counts;
  side_ = static_cast<std::size_t>(std::clamp(std::sqrt(static_cast<double>(faces.size())), 1.0, kMostSquares));
  for (;; side_ /= 2) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      squares_per_length_[axis] = static_cast<double>(side_) / std::max(upper[axis] - lower_[axis], 1e-30);
    if (count_entries(faces, counts) <= kMostEntries * faces.size() || side_ == 1) break;
  }
  for (std::size_t i = 1; i < counts.size(); ++i) counts[i] += counts[i - 1];
  starts_ = counts;
  faces_.resize(starts_.back());
  for (const Projected& face : faces)
    visit_squares(face, [&](std::size_t square) { faces_[counts[square]++] = face.number; });
}

std::vector<FaceBins::Projected> FaceBins::project_entered(const PreparedMesh& mesh, Point& upper) {
  std::vector<Projected> faces;
  lower_.fill(std::numeric_limits<double>::infinity());
  upper.fill(-lower_[0]);
  for (std::size_t i = 0; i < mesh.boundary.size(); ++i) {
    Projected face{{}, static_cast<std::uint32_t>(i)};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& vertex = mesh.vertices[mesh.boundary[i].vertices[k]];
      face.corners[k] = project({vertex.x, vertex.y, vertex.z});
    }
    const auto& [a, b, c] = face.corners;
    // Clockwise: the light enters. A hair to the other side may be rounding.
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area > 1e-14) continue;
    faces.push_back(face);
    for (const Point& p : face.corners)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        lower_[axis] = std::min(lower_[axis], p[axis]);
        upper[axis] = std::max(upper[axis], p[axis]);
      }
  }
  return faces;
}

std::size_t FaceBins::count_entries(std::span<const Projected> faces, std::vector<std::size_t>& counts) const {
  counts.assign(side_ * side_ + 1, 0);
  std::size_t total = 0;
  for (const Projected& face : faces)
    visit_squares(face, [&](std::size_t square) {
      ++counts[square + 1];
      ++total;
    });
  return total;
}

template <class Visit>
void FaceBins::visit_squares(const Projected& face, const Visit& visit) const {
  std::array<std::size_t, 2> first{}, last{};
  const auto& [a, b, c] = face.corners;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({square_of(a, axis), square_of(b, axis), square_of(c, axis)});
    const double most = static_cast<double>(side_ - 1);
    first[axis] = static_cast<std::size_t>(std::clamp(low - kMargin, 0.0, most));
    last[axis] = static_cast<std::size_t>(std::clamp(high + kMargin, 0.0, most));
  }
  for (std::size_t row = first[1]; row <= last[1]; ++row)
    for (std::size_t column = first[0]; column <= last[0]; ++column) visit(row * side_ + column);
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
