#include "src/optics/boundary_function.h"

#include "src/optics/opacity_budget.h"
#include "src/support/check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace tetravox::optics {
namespace {

constexpr double kSmoothing = 1.0 / 150.0;  // of the range
constexpr double kFlat = 0.08;              // of the largest mean gradient: below it there is no boundary
constexpr double kRare = 1e-7;              // of the volume: fewer places tell nothing
constexpr double kRarity = 0.4;             // 0: all boundaries alike; 1: the more opaque, the fewer places they take

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

  // Mean derivatives of each value, and the largest.
  std::vector<double> g(count), h(count);
  double largest_g = 0.0, largest_h = 0.0, smallest_h = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(volumes[i] > kRare * total)) continue;
    g[i] = first[i] / volumes[i];
    h[i] = second[i] / volumes[i];
    largest_g = std::max(largest_g, g[i]);
    largest_h = std::max(largest_h, h[i]);
    smallest_h = std::min(smallest_h, h[i]);
  }

  BoundaryPositions result;
  result.positions.assign(count, std::numeric_limits<double>::infinity());
  const double bend = largest_h - smallest_h;
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

  // Emphasise the middle of each boundary, rare ones more.
  std::vector<double> extinctions(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = positions_of_values[i] / shape.thickness;
    extinctions[i] = std::exp(-0.5 * x * x) * std::pow(smooth[i] * static_cast<double>(count) + 0.02, -kRarity);
  }
  extinctions = scale_to_budget(smooth, extinctions);

  const std::vector<double> u = positions(smooth);
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
