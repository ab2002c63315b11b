#include "tests/reference/segment.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetravox::reference {
namespace {

/// Beyond this optical depth (transmittance 2e-22) nothing can be seen.
constexpr double kOpaque = 50.0;

/// Nodes and weights of the ten-point Gauss-Legendre rule on [-1, 1] (symmetric halves).
constexpr std::array<double, 5> kNodes = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                          0.8650633666889845, 0.9739065285171717};
constexpr std::array<double, 5> kWeights = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                            0.1494513491505806, 0.0666713443086881};

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

/// The function at `value`, taken from the linear piece that ends at control point `upper` (so that steps have two
/// sides).
OpticalPoint eval_piece(const OpticalFunction& function, std::size_t upper, double value) {
  const auto& points = function.points;
  if (upper == 0) return points.front();
  if (upper == points.size()) return points.back();
  const OpticalPoint& a = points[upper - 1];
  const OpticalPoint& b = points[upper];
  return mix(a, b, (value - a.value) / (b.value - a.value));
}

/// Adds part [u0, u1] of a piece, over which the optical depth is at most one.
void append_part(const Piece& piece, double u0, double u1, RayIntegral& ray) {
  const double middle = 0.5 * (u0 + u1);
  const double half = 0.5 * (u1 - u0);
  const double slope = piece.back.extinction - piece.front.extinction;
  const auto depth_at = [&](double u) {
    return piece.length *
           ((piece.front.extinction + 0.5 * slope * u) * u - (piece.front.extinction + 0.5 * slope * u0) * u0);
  };
  for (std::size_t node = 0; node < kNodes.size(); ++node) {
    for (const double side : {-1.0, 1.0}) {
      const double u = middle + side * half * kNodes[node];
      const OpticalPoint point = mix(piece.front, piece.back, u);
      const double weight =
          kWeights[node] * half * piece.length * point.extinction * std::exp(-ray.optical_depth - depth_at(u));
      for (int k = 0; k < 3; ++k) ray.color[k] += weight * point.color[k];
    }
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

void append_segment(const OpticalFunction& function, double scalar_front, double scalar_back, double length,
                    RayIntegral& ray) {
  if (!(length > 0.0) || ray.optical_depth >= kOpaque) return;
  const auto& points = function.points;
  const double low = std::min(scalar_front, scalar_back);
  const double high = std::max(scalar_front, scalar_back);
  const auto above = [&](double value) {
    return static_cast<std::size_t>(
        std::upper_bound(points.begin(), points.end(), value,
                         [](double v, const OpticalPoint& point) { return v < point.value; }) -
        points.begin());
  };
  const std::size_t first = above(low);
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
