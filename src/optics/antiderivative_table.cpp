#include "src/optics/antiderivative_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tetravox::optics {
namespace {

/// Nodes over the range in which the function varies; as many again on either side where data lie beyond.
constexpr std::int32_t kNodes = 16384;
/// Error of the picture that a flat segment between two nodes may cause; where it may be more, segments are integrated
/// from control point to control point.
constexpr double kCoarseError = 3e-4;
/// T at the last node, as an integer.
constexpr double kFullScale = 1 << 30;

using Density = std::array<double, 4>;  // rho, rho*red, rho*green, rho*blue

Density density_of(const OpticalPoint& point) {
  return {point.extinction, point.extinction * point.color[0], point.extinction * point.color[1],
          point.extinction * point.color[2]};
}

/// Extinction and colour as polynomials of the distance from the start of a piece.
struct Piece {
  double begin = 0.0, end = 0.0;
  Density rates{};   // rho and colours at begin
  Density slopes{};  // of rho and colours

  /// Integrals of rho and colour * rho from `a` to `b`, both inside the piece.
  void accumulate(double a, double b, Density& sum) const {
    const double x0 = a - begin, x1 = b - begin, w = b - a;
    const double mean = 0.5 * (x0 + x1);                        // of x
    const double square = (x0 * x0 + x0 * x1 + x1 * x1) / 3.0;  // mean of x^2
    sum[0] += w * (rates[0] + slopes[0] * mean);
    for (int channel = 1; channel < 4; ++channel)
      sum[channel] +=
          w * (rates[0] * rates[channel] + (rates[0] * slopes[channel] + slopes[0] * rates[channel]) * mean +
               slopes[0] * slopes[channel] * square);
  }
};

/// rho and colour * rho at a value.
Density eval_piece(const Piece& piece, double value) {
  const double x = value - piece.begin;
  const double extinction = piece.rates[0] + piece.slopes[0] * x;
  Density density{extinction};
  for (int channel = 1; channel < 4; ++channel)
    density[channel] = extinction * (piece.rates[channel] + piece.slopes[channel] * x);
  return density;
}

Piece make_piece(const OpticalPoint& a, const OpticalPoint& b) {
  Piece piece;
  piece.begin = a.value;
  piece.end = b.value;
  piece.rates = {a.extinction, a.color[0], a.color[1], a.color[2]};
  const double width = b.value - a.value;
  if (width > 0.0 && std::isfinite(width))
    piece.slopes = {(b.extinction - a.extinction) / width, (b.color[0] - a.color[0]) / width,
                    (b.color[1] - a.color[1]) / width, (b.color[2] - a.color[2]) / width};
  return piece;
}

/// The pieces between control points that have a width, and constant ones before and after.
std::vector<Piece> make_pieces(const OpticalFunction& function) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Piece> pieces;
  const auto& points = function.points;
  OpticalPoint before = points.front();
  before.value = -kInfinity;
  pieces.push_back(make_piece(before, points.front()));
  pieces.back().begin = points.front().value - 1.0;  // finite reference; constant anyway
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    if (points[i + 1].value > points[i].value) pieces.push_back(make_piece(points[i], points[i + 1]));
  OpticalPoint after = points.back();
  after.value = kInfinity;
  pieces.push_back(make_piece(points.back(), after));
  return pieces;
}

/// The interval of values where the function varies and the data lie: what the nodes have to resolve.
ValueRange varying_range(const OpticalFunction& function, const ScalarMap& map, const ValueRange& range) {
  const double first = function.points.front().value, last = function.points.back().value;
  const ValueRange varying{std::max(first, range.min), std::min(last, range.max)};
  if (varying.max > varying.min) return varying;
  // Constant data, a constant function, or no overlap: any interval serves.
  const double middle = std::clamp(range.min, first, last);
  const double half = std::max({std::abs(middle) * 1e-6, std::abs(map.scale) * 1e-6, 1e-300});
  return {middle - half, middle + half};
}

/// Adds nodes for data beyond the ends of the function, as many again at most: there it is constant, and without nodes
/// segments take a slower path. The ends of the function stay on nodes.
ValueRange extend_range(const ValueRange& varying, const ValueRange& range, std::int32_t& count) {
  const double width = (varying.max - varying.min) / count;
  const auto beyond = [&](double distance) {
    return static_cast<std::int32_t>(std::ceil(std::clamp(distance / width, 0.0, static_cast<double>(count))));
  };
  const std::int32_t below = beyond(varying.min - range.min), above = beyond(range.max - varying.max);
  count += below + above;
  return {varying.min - below * width, varying.max + above * width};
}

/// Whether scalars may be off by half of `kFlatNodes` of `kNodes` nodes.
///
/// A stretch of length L at extinction rho whose scalar is off by ds changes the picture by rho' ds L exp(-rho L): at
/// most rho' ds / (e rho), reached at L = 1 / rho.
bool is_gentle_function(const OpticalFunction& function, const ValueRange& covered, double longest) {
  const double error = 0.5 * AntiderivativeTable::kFlatNodes * (covered.max - covered.min) / kNodes;
  for (std::size_t i = 0; i + 1 < function.points.size(); ++i) {
    const OpticalPoint& a = function.points[i];
    const OpticalPoint& b = function.points[i + 1];
    if (a.value == b.value && (a.extinction != b.extinction || a.color != b.color)) return false;
    if (a.value == b.value || b.value < covered.min || a.value > covered.max) continue;
    const double width = b.value - a.value;
    const double slope = std::abs(b.extinction - a.extinction) / width;
    const double thinnest = std::max(std::min(a.extinction, b.extinction), 1.0 / longest);
    double color_change = 0.0;
    for (int channel = 0; channel < 3; ++channel)
      color_change = std::max(color_change, std::abs(b.color[channel] - a.color[channel]));
    if (slope * error / (std::numbers::e * thinnest) > AntiderivativeTable::kGentleError) return false;
    if (color_change / width * error > AntiderivativeTable::kGentleError) return false;
  }
  return true;
}

/// Exact integrals over consecutive intervals.
class BinIntegrals {
 public:
  BinIntegrals(const OpticalFunction& function, double begin) : pieces_(make_pieces(function)), begin_(begin) {}

  /// The integrals from where the last interval ended to `end`.
  Density next(double end) {
    Density sum{};
    while (piece_ + 1 < pieces_.size() && pieces_[piece_].end <= end) {
      if (pieces_[piece_].end > begin_) {
        pieces_[piece_].accumulate(begin_, pieces_[piece_].end, sum);
        begin_ = pieces_[piece_].end;
      }
      ++piece_;
    }
    if (end > begin_) pieces_[piece_].accumulate(begin_, end, sum);
    begin_ = end;
    return sum;
  }

  /// Density where the last interval ended; at a step, beyond it.
  Density density() const { return eval_piece(pieces_[piece_], begin_); }

  /// How far the function does not change from where the last interval ended on.
  double constant_until() const {
    return pieces_[piece_].slopes == Density{} ? pieces_[piece_].end : -std::numeric_limits<double>::infinity();
  }

 private:
  std::vector<Piece> pieces_;
  std::size_t piece_ = 0;
  double begin_;
};

/// Total variation of the visible colour, largest channel; invisible stretches count when colour is next seen.
class ColorVariation {
 public:
  void add(const Density& bin) {
    if (!(bin[0] > 0.0)) return;
    const double inverse = 1.0 / bin[0];
    double change = 0.0;
    for (int channel = 0; channel < 3; ++channel) {
      const double color = bin[channel + 1] * inverse;
      if (seen_) change = std::max(change, std::abs(color - last_[channel]));
      last_[channel] = color;
    }
    seen_ = true;
    total_ += change;
    largest_ = std::max(largest_, change);
  }
  float total() const { return static_cast<float>(total_); }
  float largest() const { return static_cast<float>(largest_); }

 private:
  std::array<double, 3> last_{};
  bool seen_ = false;
  double total_ = 0.0, largest_ = 0.0;
};

/// Optical depth that an error in extinction is worth: along the longest ray, or as far as light gets.
double visible_length(double extinction, double longest) {
  return 1.0 / std::max(std::numbers::e * extinction, 1.0 / longest);
}

/// Fills nodes and colour variation, and marks the intervals between nodes in which the density is not nearly linear.
void fill_nodes(const OpticalFunction& function, const ValueRange& covered, double longest,
                AntiderivativeTable& table) {
  const std::int32_t count = table.last_node;
  const double width = (covered.max - covered.min) / count;
  const double total = BinIntegrals(function, covered.min).next(covered.max)[0] / width;
  const double unit = total > 0.0 ? total / kFullScale : 1.0;
  table.density_per_unit = static_cast<float>(unit);
  table.units_per_density = static_cast<float>(1.0 / unit);
  table.entries.resize(static_cast<std::size_t>(count) + 1);
  table.color_variation.resize(static_cast<std::size_t>(count) + 1);
  table.is_coarse.assign(static_cast<std::size_t>(count) + 1, 0);

  BinIntegrals bins(function, covered.min);
  bins.next(covered.min);
  ColorVariation variation;
  Density density = bins.density(), sum{};
  const double sum_scale = 1.0 / (unit * width);
  bool is_constant = false;
  for (std::int32_t i = 0; i <= count; ++i) {
    AntiderivativeTable::Node& node = table.entries[i];
    table.color_variation[i] = variation.total();
    for (int channel = 0; channel < 4; ++channel) {
      node.sums[channel] = static_cast<std::int32_t>(sum[channel] + 0.5);
      node.densities[channel] = static_cast<float>(density[channel]);
    }
    if (i == count) break;
    const double end = covered.min + width * (i + 1);
    const bool was_constant = is_constant;
    is_constant = end < bins.constant_until();
    const Density bin = bins.next(end);
    for (int channel = 0; channel < 4; ++channel) sum[channel] += sum_scale * bin[channel];
    // Beyond the ends of the function, often half of the nodes, no colour changes and no line is off.
    if (is_constant && was_constant) continue;
    variation.add(bin);
    const Density next = bins.density();
    double error = 0.0;
    for (int channel = 0; channel < 4; ++channel)
      error = std::max(error, std::abs(bin[channel] / width - 0.5 * (density[channel] + next[channel])));
    if (error * visible_length(std::min(density[0], next[0]), longest) > kCoarseError) table.is_coarse[i] = 1;
    density = next;
  }
  table.largest_color_slope = variation.largest();
}

/// Marks the intervals at whose control points the line between the nodes is off, and both neighbours of a step.
void mark_control_points(const OpticalFunction& function, const ValueRange& covered, double longest,
                         AntiderivativeTable& table) {
  const double inverse_width = table.last_node / (covered.max - covered.min);
  for (std::size_t k = 0; k < function.points.size(); ++k) {
    const OpticalPoint& point = function.points[k];
    const double at = (point.value - covered.min) * inverse_width;
    if (!(at >= 0.0 && at <= table.last_node)) continue;
    const auto i = std::min(static_cast<std::int32_t>(at), table.last_node - 1);
    const double f = at - i;
    const Density exact = density_of(point);
    double error = 0.0;
    for (int channel = 0; channel < 4; ++channel) {
      const double line = (1.0 - f) * table.entries[i].densities[channel] + f * table.entries[i + 1].densities[channel];
      error = std::max(error, std::abs(exact[channel] - line));
    }
    if (error * visible_length(point.extinction, longest) <= kCoarseError) continue;
    for (std::int32_t near = std::max(i - 1, 0); near <= std::min(i + 1, table.last_node); ++near)
      table.is_coarse[near] = 1;
  }
}

}  // namespace

void build_antiderivative_table(const OpticalFunction& function, const ScalarMap& map, const ValueRange& range,
                                double longest, AntiderivativeTable& table) {
  const ValueRange varying = varying_range(function, map, range);
  table.is_gentle = is_gentle_function(function, varying, longest);
  std::int32_t count = kNodes;
  const ValueRange covered = extend_range(varying, range, count);
  table.last_node = count;
  const double half_node = 0.5 * (covered.max - covered.min) / count;
  table.covers_data = range.min >= covered.min - half_node && range.max <= covered.max + half_node;
  table.first = map.stored_from_value(covered.min);
  table.nodes_per_scalar = static_cast<float>(map.scale * count / (covered.max - covered.min));
  fill_nodes(function, covered, longest, table);
  mark_control_points(function, covered, longest, table);
  table.coarse_before.assign(1, 0);
  for (const std::int32_t marked : table.is_coarse) table.coarse_before.push_back(table.coarse_before.back() + marked);
  table.has_coarse = table.coarse_before.back() > 0;

  const bool starts_here = covered.min <= function.points.front().value;
  const Density below =
      density_of(starts_here ? function.points.front() : eval_optical_function(function, covered.min));
  const Density above = density_of(eval_optical_function(function, covered.max));
  for (int channel = 0; channel < 4; ++channel) {
    table.density_below[channel] = static_cast<float>(below[channel]);
    table.density_above[channel] = static_cast<float>(above[channel]);
  }
}

ControlPointTable build_control_point_table(const OpticalFunction& function, const ScalarMap& map) {
  constexpr std::int32_t kBuckets = 4096;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto& points = function.points;
  ControlPointTable table;

  const auto add_interval = [&](float start, const OpticalPoint& a, const OpticalPoint* b) {
    table.starts.push_back(start);
    table.references.push_back(map.stored_from_value(a.value));
    table.densities_front.push_back({static_cast<float>(a.extinction), static_cast<float>(a.color[0]),
                                     static_cast<float>(a.color[1]), static_cast<float>(a.color[2])});
    std::array<float, 4> slope{};
    if (b) {
      const double scale = map.scale / (b->value - a.value);
      slope = {static_cast<float>((b->extinction - a.extinction) * scale),
               static_cast<float>((b->color[0] - a.color[0]) * scale),
               static_cast<float>((b->color[1] - a.color[1]) * scale),
               static_cast<float>((b->color[2] - a.color[2]) * scale)};
    }
    table.slopes.push_back(slope);
  };
  add_interval(-kInfinity, points.front(), nullptr);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const float start = map.stored_from_value(points[i].value);
    if (map.stored_from_value(points[i + 1].value) > start) add_interval(start, points[i], &points[i + 1]);
  }
  add_interval(map.stored_from_value(points.back().value), points.back(), nullptr);
  table.interval_count = static_cast<std::int32_t>(table.starts.size());
  table.starts.push_back(kInfinity);

  // Remember for each bucket of scalars the interval that its lower end lies in.
  table.first = map.stored_from_value(points.front().value);
  const float width = map.stored_from_value(points.back().value) - table.first;
  table.buckets_per_scalar = width > 0.0f ? static_cast<float>(kBuckets) / width : 0.0f;
  table.first_interval.resize(kBuckets);
  std::int32_t interval = 0;
  for (std::int32_t bucket = 0; bucket < kBuckets; ++bucket) {
    // One bucket early: the bucket of a scalar is computed with rounding.
    const float lower = table.first + width * (static_cast<float>(bucket - 1) / kBuckets);
    while (interval + 1 < table.interval_count && table.starts[interval + 1] <= lower) ++interval;
    table.first_interval[bucket] = bucket == 0 ? 0 : interval;
  }
  return table;
}

std::array<float, 4> eval_densities(const ControlPointTable& points, std::size_t interval, float scalar) {
  const float x = scalar - points.references[interval];
  const auto value = [&](std::size_t i) {
    return points.densities_front[interval][i] + points.slopes[interval][i] * x;
  };
  const float rho = std::max(value(0), 0.0f);
  return {rho, rho * value(1), rho * value(2), rho * value(3)};
}

std::array<float, 4> eval_densities(const ControlPointTable& points, float scalar) {
  if (!(scalar == scalar)) return {scalar, scalar, scalar, scalar};
  const auto last = static_cast<float>(points.first_interval.size() - 1);
  const float bucket = std::clamp((scalar - points.first) * points.buckets_per_scalar, 0.0f, last);
  auto interval = static_cast<std::size_t>(points.first_interval[static_cast<std::size_t>(bucket)]);
  while (points.starts[interval + 1] <= scalar) ++interval;
  return eval_densities(points, interval, scalar);
}

}  // namespace tetravox::optics
