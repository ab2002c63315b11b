#include "src/scene/grid_samples.h"
#include "src/scene/histogram_limits.h"
#include "src/scene/robust_range.h"
#include "src/scene/shown_bricks.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetravox {
namespace {

constexpr std::size_t kLargestSampleCount = 2'000'000;
constexpr double kFewestWholeNumbers = 64;  // fewer may be labels, which stay apart

bool is_integer(ScalarType type) { return type != ScalarType::kFloat32 && type != ScalarType::kFloat64; }

/// Counts in equal bins over `range`, each value spread evenly over `step` (0: not at all).
std::vector<double> count_values(const scene::GridSamples& samples, const ValueRange& range, int bins, double step) {
  std::vector<double> counts(static_cast<std::size_t>(bins));
  const double bins_per_value = bins / (range.max - range.min), last = bins - 1.0;
  const int pieces = std::clamp(static_cast<int>(std::ceil(step * bins_per_value)), 1, bins);
  for (std::size_t i = 0; i < samples.values.size(); ++i)
    for (int piece = 0; piece < pieces; ++piece) {
      const double value = samples.values[i] + step * ((piece + 0.5) / pieces - 0.5);
      const double bin = std::clamp((value - range.min) * bins_per_value, 0.0, last);
      counts[static_cast<std::size_t>(bin)] += static_cast<double>(samples.weights[i]) / pieces;
    }
  return counts;
}

/// Leaves only what is no background.
void drop_background(scene::GridSamples& samples, const scene::Background& background) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples.values.size(); ++i) {
    if (background.holds(samples.values[i])) continue;
    samples.values[kept] = samples.values[i];
    samples.weights[kept++] = samples.weights[i];
  }
  samples.values.resize(kept);
  samples.weights.resize(kept);
}

/// The mean chord of the box around everything but the background: 4 volume / area (Cauchy 1841).
std::optional<double> suitable_unit_distance(const PreparedGrid& grid,
                                             const std::optional<scene::Background>& background) {
  const auto box = scene::bounds_of_bricks(
      grid, [&](float min, float max) { return !background || !background->holds(min) || !background->holds(max); });
  if (!box) return std::nullopt;
  const double x = (*box)[0].max - (*box)[0].min, y = (*box)[1].max - (*box)[1].min, z = (*box)[2].max - (*box)[2].min;
  const double area = 2.0 * (x * y + y * z + z * x);
  if (!(area > 0.0)) return std::nullopt;
  return scene::unit_distance_for_chord(4.0 * x * y * z / area, grid.bounds);
}

}  // namespace

Histogram make_histogram(const PreparedGrid& grid, int bins) {
  scene::require_bin_count(bins);
  const auto stored = [&](double value) { return (value - grid.scalar_offset) / grid.scalar_scale; };
  const auto value_of = [&](double scalar) { return grid.scalar_offset + scalar * grid.scalar_scale; };
  Histogram histogram;
  histogram.range = grid.scalar_range;
  histogram.counts.resize(static_cast<std::size_t>(bins));
  scene::GridSamples samples = scene::sample_grid(grid, kLargestSampleCount);
  const std::optional<scene::Background> background = scene::find_background(samples);
  histogram.unit_distance = suitable_unit_distance(grid, background);
  ValueRange range{stored(grid.scalar_range.min), stored(grid.scalar_range.max)};
  if (background) {
    drop_background(samples, *background);
    const ValueRange inside{std::clamp<double>(background->low, range.min, range.max),
                            std::clamp<double>(background->high, range.min, range.max)};
    histogram.background = ValueRange{value_of(inside.min), value_of(inside.max)};
    if (std::isinf(background->low)) range.min = inside.max;
    if (std::isinf(background->high)) range.max = inside.min;
  }
  if (!(range.max > range.min) || samples.values.empty()) {
    histogram.counts[histogram.counts.size() / 2] = 1.0;
    return histogram;
  }
  range = scene::robust_range(
      range, [&](const ValueRange& part, int count) { return count_values(samples, part, count, 0.0); });
  const double whole = is_integer(grid.data.type) && grid.data.component != kMagnitude ? 1.0 / grid.scalar_scale : 0.0;
  const bool is_spread = range.max - range.min > kFewestWholeNumbers * whole;
  histogram.counts = count_values(samples, range, bins, is_spread ? whole : 0.0);
  histogram.range = {value_of(range.min), value_of(range.max)};
  return histogram;
}

}  // namespace tetravox
