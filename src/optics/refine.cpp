#include "src/optics/refine.h"

#include <algorithm>
#include <cmath>

namespace tetravox::optics {
namespace {

constexpr int kLargestDepth = 12;
constexpr double kSafety = 0.5;  // the largest error need not be at one of the three places looked at

void append(std::vector<ControlPoint>& points, ControlPoint point) {
  if (!points.empty()) {
    const ControlPoint& last = points.back();
    point.value = std::max(point.value, last.value);  // rounding must not make values descend
    if (point.value == last.value && point.color == last.color && point.absorption == last.absorption) return;
  }
  points.push_back(point);
}

bool is_close(const ControlPoint& a, const ControlPoint& b, const ControlPoint& exact, double absorption_tolerance) {
  const double width = 0.5 * b.value - 0.5 * a.value;  // halves: the whole may overflow
  if (!(width > 0.0)) return true;
  const double t = (0.5 * exact.value - 0.5 * a.value) / width;
  for (int i = 0; i < 3; ++i)
    if (std::abs(std::lerp(a.color[i], b.color[i], t) - exact.color[i]) > kSafety * kColorTolerance) return false;
  return std::abs(std::lerp(a.absorption, b.absorption, t) - exact.absorption) <= kSafety * absorption_tolerance;
}

/// Appends what is needed between `a` (already there) and `b`, and `b`.
void refine_between(const Curve& curve, std::size_t piece, double u_a, const ControlPoint& a, double u_b,
                    const ControlPoint& b, int depth, std::vector<ControlPoint>& points) {
  const ControlPoint middle = curve.eval(piece, 0.5 * (u_a + u_b));
  const bool is_linear = is_close(a, b, middle, curve.absorption_tolerance) &&
                         is_close(a, b, curve.eval(piece, 0.75 * u_a + 0.25 * u_b), curve.absorption_tolerance) &&
                         is_close(a, b, curve.eval(piece, 0.25 * u_a + 0.75 * u_b), curve.absorption_tolerance);
  if (depth == kLargestDepth || is_linear) {
    append(points, b);
    return;
  }
  refine_between(curve, piece, u_a, a, 0.5 * (u_a + u_b), middle, depth + 1, points);
  refine_between(curve, piece, 0.5 * (u_a + u_b), middle, u_b, b, depth + 1, points);
}

}  // namespace

std::vector<ControlPoint> refine(const Curve& curve) {
  std::vector<ControlPoint> points;
  for (std::size_t piece = 0; piece < curve.piece_count; ++piece) {
    const ControlPoint begin = curve.eval(piece, 0.0), end = curve.eval(piece, 1.0);
    append(points, begin);
    refine_between(curve, piece, 0.0, begin, 1.0, end, 0, points);
  }
  return points;
}

}  // namespace tetravox::optics
