#include "tetravox/transfer_function.h"

#include "src/optics/validate.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tetravox {
namespace {

/// Appends the linear pieces of -ln(1 - opacity) / d between two points, without the first point.
///
/// Extinction is convex in opacity: a chord lies above it, and is furthest off where the slopes agree, which is where
/// 1 - opacity is the logarithmic mean of its values at the ends.
class ExtinctionRefiner {
 public:
  ExtinctionRefiner(double unit_distance, double tolerance) : distance_(unit_distance), tolerance_(tolerance) {}

  void refine(const ControlPoint& a, const ControlPoint& b, std::vector<OpticalPoint>& points) const {
    refine_between(a, b, 1.0 - a.absorption, 1.0 - b.absorption, 0, points);
    points.push_back({b.value, -std::log1p(-b.absorption) / distance_, b.color});
  }

 private:
  /// Appends points strictly between two places of the segment, given by their transparency (1 - opacity).
  void refine_between(const ControlPoint& a, const ControlPoint& b, double front, double back, int depth,
                      std::vector<OpticalPoint>& points) const {
    const double log_ratio = std::log(front / back);  // back optical depth less front optical depth
    const double smaller_depth = -std::log(std::max(front, back));
    if (depth == kLargestDepth || chord_error(front, back, log_ratio) <= tolerance_ * (1.0 + smaller_depth)) return;
    const double middle = std::sqrt(front * back);
    refine_between(a, b, front, middle, depth + 1, points);
    const double t = ((1.0 - a.absorption) - middle) / (b.absorption - a.absorption);
    const OpticalPoint point{std::lerp(a.value, b.value, t),
                             -std::log(middle) / distance_,
                             {std::lerp(a.color[0], b.color[0], t), std::lerp(a.color[1], b.color[1], t),
                              std::lerp(a.color[2], b.color[2], t)}};
    if (point.value > points.back().value && point.value < b.value) points.push_back(point);
    refine_between(a, b, middle, back, depth + 1, points);
  }

  /// Largest distance between the chord and the curve, as an optical depth over the unit distance.
  static double chord_error(double front, double back, double log_ratio) {
    const double drop = front - back;
    if (std::abs(drop) < 1e-12 || log_ratio == 0.0) return 0.0;
    const double touch = drop / log_ratio;  // logarithmic mean
    const double on_chord = -std::log(front) + (front - touch) / touch;
    return on_chord + std::log(touch);
  }

  static constexpr int kLargestDepth = 16;
  double distance_;
  double tolerance_;
};

std::vector<OpticalPoint> points_from_opacities(const TransferFunction& function, double unit_distance,
                                                double tolerance) {
  std::vector<OpticalPoint> points;
  const ExtinctionRefiner refiner(unit_distance, tolerance);
  ControlPoint previous;
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    ControlPoint point = function.points[i];
    point.absorption = std::min(point.absorption, kLargestOpacity);
    if (i > 0 && point.value > previous.value)
      refiner.refine(previous, point, points);
    else
      points.push_back({point.value, -std::log1p(-point.absorption) / unit_distance, point.color});
    previous = point;
  }
  return points;
}

}  // namespace

namespace optics {

void validate_transfer_function(const TransferFunction& function) {
  const auto fail = [](std::size_t i, const std::string& what) {
    throw Error(ErrorCode::kInvalidArgument, "transfer function point " + std::to_string(i) + ": " + what);
  };
  if (function.points.empty())
    throw Error(ErrorCode::kInvalidArgument, "transfer function without points; give at least one");
  if (function.unit_distance && !(std::isfinite(*function.unit_distance) && *function.unit_distance > 0.0))
    throw Error(ErrorCode::kInvalidArgument, "transfer function: unit_distance must be a finite number above 0");
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    const ControlPoint& point = function.points[i];
    if (!std::isfinite(point.value)) fail(i, "the value is not finite");
    if (i > 0 && point.value < function.points[i - 1].value) fail(i, "values must ascend; sort the points");
    for (const double channel : point.color)
      if (!(channel >= 0.0 && channel <= 1.0)) fail(i, "colours are three numbers in [0, 1]");
    if (function.absorption == Absorption::kOpacity && !(point.absorption >= 0.0 && point.absorption <= 1.0))
      fail(i, "opacity must be in [0, 1]");
    if (!(point.absorption >= 0.0 && std::isfinite(point.absorption)))
      fail(i, "extinction must be finite and not negative");
  }
}

}  // namespace optics

OpticalFunction make_optical_function(const TransferFunction& function, double default_unit_distance,
                                      double tolerance) {
  optics::validate_transfer_function(function);
  if (!(tolerance > 0.0)) throw Error(ErrorCode::kInvalidArgument, "transfer function: tolerance must be above 0");
  OpticalFunction optical;
  if (function.absorption == Absorption::kExtinction) {
    optical.points.reserve(function.points.size());
    for (const ControlPoint& point : function.points)
      optical.points.push_back({point.value, point.absorption, point.color});
    return optical;
  }
  const double unit_distance = function.unit_distance.value_or(default_unit_distance);
  if (!(std::isfinite(unit_distance) && unit_distance > 0.0))
    throw Error(ErrorCode::kInvalidArgument, "transfer function: unit_distance must be a finite number above 0");
  if (!std::isfinite(-std::log1p(-kLargestOpacity) / unit_distance))
    throw Error(ErrorCode::kInvalidArgument, "transfer function: unit_distance is too small");
  optical.points = points_from_opacities(function, unit_distance, tolerance);
  return optical;
}

OpticalPoint eval_optical_function(const OpticalFunction& function, double value) {
  if (function.points.empty())
    throw Error(ErrorCode::kInvalidArgument, "optical function without points; give at least one");
  OpticalPoint result{value, 0.0, {}};
  if (std::isnan(value)) return result;
  const auto above = std::upper_bound(function.points.begin(), function.points.end(), value,
                                      [](double v, const OpticalPoint& point) { return v < point.value; });
  const OpticalPoint& b = above == function.points.end() ? function.points.back() : *above;
  const OpticalPoint& a = above == function.points.begin() ? function.points.front() : *(above - 1);
  double t = 0.0;
  const double width = 0.5 * b.value - 0.5 * a.value;  // halves: the whole may overflow
  if (width > 0.0) t = std::clamp((0.5 * value - 0.5 * a.value) / width, 0.0, 1.0);
  result.extinction = std::lerp(a.extinction, b.extinction, t);
  for (int i = 0; i < 3; ++i) result.color[i] = std::lerp(a.color[i], b.color[i], t);
  return result;
}

}  // namespace tetravox
