#include "tests/reference/segment.h"

#include "tests/reference/quadrature.h"

#include <algorithm>
#include <cmath>

namespace tetravox::reference {
namespace {

/// A stretch of the ray on which extinction and colour are linear.
struct Piece {
  OpticalPoint front, back;
  double length = 0.0;
};

OpticalPoint mix(const OpticalPoint& a, const OpticalPoint& b, double u) {
  OpticalPoint result;
  result.value = a.value + u * (b.value - a.value);
  result.extinction = a.extinction + u * (b.extinction - a.extinction);
  for (int k = 0; k < 3; ++k) result.color[k] = a.color[k] + u * (b.color[k] - a.color[k]);
  return result;
}

/// Adds part [u0, u1] of a piece, over which the optical depth is at most one.
void append_part(const Piece& piece, double u0, double u1, RayIntegral& ray) {
  const GaussRule& rule = gauss_rule();
  const double slope = piece.back.extinction - piece.front.extinction;
  const auto depth_at = [&](double u) {
    return piece.length *
           ((piece.front.extinction + 0.5 * slope * u) * u - (piece.front.extinction + 0.5 * slope * u0) * u0);
  };
  for (int node = 0; node < kNodeCount; ++node) {
    const double u = u0 + (u1 - u0) * rule.node[node];
    const OpticalPoint point = mix(piece.front, piece.back, u);
    const double weight =
        rule.weight[node] * (u1 - u0) * piece.length * point.extinction * std::exp(-ray.optical_depth - depth_at(u));
    for (int k = 0; k < 3; ++k) ray.color[k] += weight * point.color[k];
  }
  ray.optical_depth += depth_at(u1);
}

void append_piece(const Piece& piece, RayIntegral& ray) {
  const double largest = piece.length * std::max(piece.front.extinction, piece.back.extinction);
  if (largest == 0.0) return;
  // Huge depths are cut finely enough by a bounded number of parts: all but the first are invisible.
  const int parts = static_cast<int>(std::ceil(std::clamp(largest, 1.0, 1e6)));
  for (int part = 0; part < parts && ray.optical_depth < kOpaque; ++part)
    append_part(piece, static_cast<double>(part) / parts, static_cast<double>(part + 1) / parts, ray);
}

}  // namespace

std::size_t find_piece(const OpticalFunction& function, double value) {
  const auto& points = function.points;
  return static_cast<std::size_t>(
      std::upper_bound(points.begin(), points.end(), value,
                       [](double v, const OpticalPoint& point) { return v < point.value; }) -
      points.begin());
}

OpticalPoint eval_piece(const OpticalFunction& function, std::size_t upper, double value) {
  const auto& points = function.points;
  if (upper == 0) return points.front();
  if (upper == points.size()) return points.back();
  const OpticalPoint& a = points[upper - 1];
  const OpticalPoint& b = points[upper];
  return mix(a, b, (value - a.value) / (b.value - a.value));
}

void append_segment(const OpticalFunction& function, double scalar_front, double scalar_back, double length,
                    RayIntegral& ray) {
  if (!(length > 0.0) || ray.optical_depth >= kOpaque) return;
  const auto& points = function.points;
  const double low = std::min(scalar_front, scalar_back);
  const double high = std::max(scalar_front, scalar_back);
  const std::size_t first = find_piece(function, low);
  if (low == high) {
    const OpticalPoint point = eval_piece(function, first, low);
    append_piece({point, point, length}, ray);
    return;
  }
  // Walk the linear pieces between `low` and `high` in the order in which the ray meets them.
  std::size_t last = first;
  while (last < points.size() && points[last].value < high) ++last;
  const bool rises = scalar_back > scalar_front;
  for (std::size_t i = 0; i <= last - first; ++i) {
    const std::size_t upper = rises ? first + i : last - i;
    const double from = upper == first ? low : points[upper - 1].value;
    const double to = upper == last ? high : points[upper].value;
    if (!(to > from)) continue;
    OpticalPoint front = eval_piece(function, upper, from);
    OpticalPoint back = eval_piece(function, upper, to);
    if (!rises) std::swap(front, back);
    append_piece({front, back, length * ((to - from) / (high - low))}, ray);
  }
}

}  // namespace tetravox::reference
