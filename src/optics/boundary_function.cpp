#include "src/optics/boundary_function.h"

#include "src/optics/opacity_budget.h"
#include "src/support/check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>

namespace tetravox::optics {
namespace {

constexpr double kSmoothing = 1.0 / 150.0;  // of the range
constexpr double kFlat = 0.08;              // of the largest mean gradient: below it there is no boundary
constexpr double kRare = 1e-6;              // of the volume: fewer places tell nothing
constexpr double kColorsByValue = 0.2;      // 0: the same length of the colours for everything emphasised
constexpr double kLeastDepth = 0.1;         // of a ray, on average, if need be with thicker boundaries
constexpr double kMostWidening = 10.0;
constexpr double kTail = 0.01;   // of the area of all iso-surfaces, whose derivatives are outliers
constexpr double kRarity = 0.4;  // 0: all boundaries alike; 1: the more opaque, the fewer places they take

/// Shares of the volume outside the background; of all where nothing else is.
std::vector<double> shares_outside(const DerivativeProfile& profile, const std::optional<ValueRange>& background) {
  std::vector<double> shares = profile.volumes;
  const double width = (profile.range.max - profile.range.min) / static_cast<double>(shares.size());
  for (std::size_t i = 0; background && i < shares.size(); ++i) {
    const double value = profile.range.min + (static_cast<double>(i) + 0.5) * width;
    if (value >= background->min && value <= background->max) shares[i] = 0.0;
  }
  double total = 0.0;
  for (const double share : shares) total += share;
  if (!(total > 0.0)) return shares_outside(profile, std::nullopt);
  for (double& share : shares) share /= total;
  return shares;
}

/// The number below which lie numbers with `part` of all weight; 0 without weight.
double quantile(const std::vector<double>& numbers, const std::vector<double>& weights, double part) {
  std::vector<std::size_t> order(numbers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return numbers[a] != numbers[b] ? numbers[a] < numbers[b] : a < b; });
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  double below = 0.0;
  for (const std::size_t i : order) {
    below += weights[i];
    if (below > part * total) return numbers[i];
  }
  return 0.0;
}

/// The boundary emphasis function b(p(v)): a Gaussian.
std::vector<double> emphasise(const std::vector<double>& positions, double thickness) {
  std::vector<double> emphasis(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    emphasis[i] = std::exp(-0.5 * (positions[i] / thickness) * (positions[i] / thickness));
  return emphasis;
}

TransferFunction constant_function(const DerivativeProfile& profile, const BoundaryShape& shape) {
  TransferFunction function;
  function.absorption = Absorption::kOpacity;
  function.unit_distance = shape.unit_distance;
  function.points = {{profile.range.min, color_at(0.35, shape.invert), opacity_from_extinction(kBodyExtinction)}};
  return function;
}

}  // namespace

BoundaryPositions find_boundary_positions(const DerivativeProfile& profile) {
  const std::size_t count = profile.volumes.size();
  const double smoothing = kSmoothing * static_cast<double>(count);
  const std::vector<double> volumes = smoothed(profile.volumes, smoothing), first = smoothed(profile.first, smoothing),
                            second = smoothed(profile.second, smoothing);
  double total = 0.0;
  for (const double volume : volumes) total += volume;
  std::vector<double> g(count), h(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(volumes[i] > kRare * total)) continue;
    g[i] = first[i] / volumes[i];
    h[i] = second[i] / volumes[i];
  }

  BoundaryPositions result;
  result.positions.assign(count, std::numeric_limits<double>::infinity());
  const double largest_g = quantile(g, first, 1.0 - kTail);
  const double bend = quantile(h, first, 1.0 - kTail) - quantile(h, first, kTail);
  // A field that bends nowhere is one wide boundary.
  result.sigma = bend > 0.0 ? 2.0 * std::sqrt(std::numbers::e) * largest_g / bend : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double steepness = g[i] - kFlat * largest_g;
    if (steepness > 0.0) result.positions[i] = -result.sigma * h[i] / steepness;
  }
  return result;
}

TransferFunction make_boundary_function(const DerivativeProfile& profile, const BoundaryShape& shape) {
  TETRAVOX_CHECK_EQ(profile.volumes.size(), profile.first.size());
  TETRAVOX_CHECK_EQ(profile.volumes.size(), profile.second.size());
  if (!(profile.range.max > profile.range.min)) return constant_function(profile, shape);
  const std::size_t count = profile.volumes.size();
  const std::vector<double> positions_of_values = find_boundary_positions(profile).positions;
  const std::vector<double> shares = shares_outside(profile, shape.background);
  const std::vector<double> smooth = smoothed(shares, static_cast<double>(count) / 128.0);

  // Emphasise the middle of each boundary, rare ones more, as thick as it takes to see something at all.
  std::vector<double> emphasis, extinctions(count), crowds(count);
  double thickness = shape.thickness;
  do {
    emphasis = emphasise(positions_of_values, thickness);
    for (std::size_t i = 0; i < count; ++i)
      extinctions[i] = emphasis[i] * std::pow(smooth[i] * static_cast<double>(count) + 0.1, -kRarity);
    extinctions = scale_to_budget(smooth, extinctions);
    thickness *= 1.25;
  } while (mean_depth(smooth, extinctions) < kLeastDepth && thickness < kMostWidening * shape.thickness);

  // Spread the colours over what is emphasised.
  for (std::size_t i = 0; i < count; ++i) crowds[i] = emphasis[i] * smooth[i];
  const std::vector<double> u = positions(crowds, kColorsByValue);
  TransferFunction function;
  function.absorption = Absorption::kOpacity;
  function.unit_distance = shape.unit_distance;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    function.points.push_back({std::lerp(profile.range.min, profile.range.max, t), color_at(u[i], shape.invert),
                               opacity_from_extinction(extinctions[i])});
  }
  return function;
}

}  // namespace tetravox::optics
