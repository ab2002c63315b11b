#include "src/optics/segment_integral.h"

#include "src/optics/transparency_table.h"

#include <algorithm>
#include <cmath>

namespace tetravox::optics {
namespace {

/// Scalars that differ by less tell rounding, not integrals.
constexpr double kSmallestDifference = 1e-10;
/// Over steps as short as that densities are taken from the middle: differences of integrals would lose digits.
constexpr double kSmallestStep = 1e-6;

OpticalDensity density_of(const std::array<double, 4>& rates) {
  return {rates[0], rates[0] * rates[1], rates[0] * rates[2], rates[0] * rates[3]};
}

OpticalPoint mix_points(const OpticalPoint& a, const OpticalPoint& b, double t) {
  OpticalPoint point;
  point.value = std::lerp(a.value, b.value, t);
  point.extinction = std::lerp(a.extinction, b.extinction, t);
  for (int channel = 0; channel < 3; ++channel) point.color[channel] = std::lerp(a.color[channel], b.color[channel], t);
  return point;
}

}  // namespace

Slab eval_homogeneous(const OpticalDensity& mean, double length) {
  const double depth = mean[0] * length, opacity = -std::expm1(-depth);
  const double visible = depth > 0.0 ? length * (opacity / depth) : 0.0;
  return {{mean[1] * visible, mean[2] * visible, mean[3] * visible}, opacity};
}

SegmentIntegral::SegmentIntegral(const OpticalFunction& function, const ValueRange& range) {
  const auto& points = function.points;
  const double width = range.max - range.min;
  const auto place = [&](std::size_t i) { return (points[i].value - range.min) / width; };
  if (place(0) > 0.0) append(0.0, std::min(place(0), 1.0), points[0], points[0]);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double a = place(i), b = place(i + 1);
    if (!(b > 0.0) || !(a < 1.0) || !(b > a)) continue;
    const double from = std::max(a, 0.0), to = std::min(b, 1.0);
    append(from, to, mix_points(points[i], points[i + 1], (from - a) / (b - a)),
           mix_points(points[i], points[i + 1], (to - a) / (b - a)));
  }
  const double last = place(points.size() - 1);
  if (last < 1.0) append(std::max(last, 0.0), 1.0, points.back(), points.back());
  const OpticalPoint end = eval_optical_function(function, range.max);
  append(1.0, 2.0, end, end);
  pieces_.front().begin = 0.0;
  index_pieces();
}

void SegmentIntegral::append(double begin, double end, const OpticalPoint& a, const OpticalPoint& b) {
  largest_extinction_ = std::max({largest_extinction_, a.extinction, b.extinction});
  Piece piece;
  piece.begin = begin;
  piece.rates = {a.extinction, a.color[0], a.color[1], a.color[2]};
  const std::array<double, 4> ends{b.extinction, b.color[0], b.color[1], b.color[2]};
  for (int i = 0; i < 4; ++i) piece.slopes[i] = (ends[i] - piece.rates[i]) / (end - begin);
  piece.constant = density_of(piece.rates);
  piece.linear[0] = piece.slopes[0];
  for (int i = 1; i < 4; ++i) {
    piece.linear[i] = piece.rates[0] * piece.slopes[i] + piece.slopes[0] * piece.rates[i];
    piece.square[i] = piece.slopes[0] * piece.slopes[i];
  }
  if (!pieces_.empty()) piece.integral = integral_in(pieces_.back(), begin);
  pieces_.push_back(piece);
}

void SegmentIntegral::index_pieces() {
  const std::size_t parts = 4 * pieces_.size();
  std::uint32_t piece = 0;
  for (std::size_t part = 0; part <= parts; ++part) {
    // A hair below the part's lower end: rounding must not begin a search behind its scalar.
    const double lower = (static_cast<double>(part) - 1e-6) / static_cast<double>(parts);
    while (piece + 1 < pieces_.size() && pieces_[piece + 1].begin <= lower) ++piece;
    first_pieces_.push_back(piece);
  }
}

std::size_t SegmentIntegral::find(double s) const {
  if (!(s > 0.0)) return 0;
  if (s >= 1.0) return pieces_.size() - 1;
  std::size_t i = first_pieces_[static_cast<std::size_t>(s * static_cast<double>(first_pieces_.size() - 1))];
  while (s >= pieces_[i + 1].begin) ++i;
  return i;
}

std::array<double, 4> SegmentIntegral::rates_in(const Piece& piece, double s) {
  std::array<double, 4> rates;
  for (int i = 0; i < 4; ++i) rates[i] = piece.rates[i] + piece.slopes[i] * (s - piece.begin);
  rates[0] = std::max(rates[0], 0.0);
  return rates;
}

OpticalDensity SegmentIntegral::density_in(const Piece& piece, double s) { return density_of(rates_in(piece, s)); }

OpticalDensity SegmentIntegral::integral_in(const Piece& piece, double s) {
  const double x = s - piece.begin;
  OpticalDensity sum;
  for (int i = 0; i < 4; ++i)
    sum[i] = piece.integral[i] + x * (piece.constant[i] + x * (0.5 * piece.linear[i] + x * piece.square[i] / 3.0));
  return sum;
}

OpticalDensity SegmentIntegral::mean(double a, double b) const {
  const Piece &first = pieces_[find(a)], &last = pieces_[find(b)];
  const double difference = b - a;
  OpticalDensity mean;
  if (std::abs(difference) < kSmallestDifference) {
    const OpticalDensity front = density_in(first, a), back = density_in(last, b);
    for (int i = 0; i < 4; ++i) mean[i] = 0.5 * (front[i] + back[i]);
    return mean;
  }
  const OpticalDensity from = integral_in(first, a), to = integral_in(last, b);
  for (int i = 0; i < 4; ++i) mean[i] = std::max((to[i] - from[i]) / difference, 0.0);
  return mean;
}

Slab SegmentIntegral::integrate(double a, double b, double length) const {
  if (a == b) return eval_homogeneous(density(a), length);
  const bool rises = b > a;
  const double length_per_s = length / std::abs(b - a);
  const auto add_piece = [&](const Piece& piece, double from, double to, Slab& sum) {
    const std::array<double, 4> front = rates_in(piece, from), back = rates_in(piece, to);
    const double part = std::abs(to - from) * length_per_s;
    const double absorbed = eval_absorbed(front[0] * part, back[0] * part);
    const double opacity = -std::expm1(-0.5 * (front[0] + back[0]) * part);
    Slab slab{{}, opacity};
    for (int i = 0; i < 3; ++i) slab.color[i] = front[i + 1] * absorbed + back[i + 1] * (opacity - absorbed);
    sum = composite(sum, slab);
  };
  Slab sum;
  const double low = std::min(a, b), high = std::max(a, b);
  const std::size_t first = find(low), last = find(high);
  for (std::size_t i = first; i <= last; ++i) {
    const std::size_t piece = rises ? i : first + last - i;
    const double from = std::max(low, pieces_[piece].begin);
    const double to = piece == last ? high : pieces_[piece + 1].begin;
    if (to > from) add_piece(pieces_[piece], rises ? from : to, rises ? to : from, sum);
  }
  return sum;
}

Slab SegmentIntegral::integrate_in_steps(double a, double b, double length, int steps) const {
  const double step = (b - a) / steps, step_length = length / steps;
  Slab sum;
  if (std::abs(step) < kSmallestStep) {
    for (int i = 0; i < steps; ++i) sum = composite(sum, eval_homogeneous(density(a + step * (i + 0.5)), step_length));
    return sum;
  }
  const double inverse = 1.0 / step;
  OpticalDensity before = integral_in(pieces_[find(a)], a);
  for (int i = 1; i <= steps; ++i) {
    const double to = i == steps ? b : a + step * i;
    const OpticalDensity after = integral_in(pieces_[find(to)], to);
    OpticalDensity mean;
    for (int c = 0; c < 4; ++c) mean[c] = std::max((after[c] - before[c]) * inverse, 0.0);
    sum = composite(sum, eval_homogeneous(mean, step_length));
    before = after;
  }
  return sum;
}

}  // namespace tetravox::optics
