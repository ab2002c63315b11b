#include "src/optics/steepness_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace tetravox::optics {
namespace {

constexpr float kStep = 1e30f;
constexpr int kBins = SteepnessTable::kBins;

using Densities = std::array<float, 4>;  // rho, rho * red, rho * green, rho * blue

/// Bound on the change of densities in one interval between two scalars.
float bound_slope(const ControlPointTable& points, std::size_t interval, float low, float high) {
  const auto& slope = points.slopes[interval];
  const float rho = std::max(eval_densities(points, interval, low)[0], eval_densities(points, interval, high)[0]);
  float largest = std::abs(slope[0]);
  for (std::size_t i = 1; i < 4; ++i) largest = std::max(largest, std::abs(slope[0]) + rho * std::abs(slope[i]));
  return largest;
}

void fill_levels(std::vector<float>& table) {
  for (int level = 1; level < SteepnessTable::kLevels; ++level) {
    const int half = 1 << (level - 1);
    const float* from = table.data() + static_cast<std::ptrdiff_t>(level - 1) * kBins;
    float* to = table.data() + static_cast<std::ptrdiff_t>(level) * kBins;
    for (int i = 0; i < kBins; ++i) to[i] = std::max(from[i], from[std::min(i + half, kBins - 1)]);
  }
}

}  // namespace

int SteepnessTable::bin_of(float scalar) const {
  return static_cast<int>(std::clamp((scalar - first) * bins_per_scalar, 0.0f, static_cast<float>(kBins - 1)));
}

float SteepnessTable::largest(const std::vector<float>& table, float min, float max) const {
  const int low = bin_of(min), high = bin_of(max);
  const int level = std::bit_width(static_cast<unsigned>(high - low + 1)) - 1;
  const float* row = table.data() + static_cast<std::ptrdiff_t>(level) * kBins;
  return std::max(row[low], row[high - (1 << level) + 1]);
}

void build_steepness_table(const ControlPointTable& points, float min, float max, SteepnessTable& table) {
  table.first = min;
  table.bins_per_scalar = max > min ? static_cast<float>(kBins) / (max - min) : 0.0f;
  table.steepness.assign(static_cast<std::size_t>(SteepnessTable::kLevels) * kBins, 0.0f);
  table.extinction.assign(static_cast<std::size_t>(SteepnessTable::kLevels) * kBins, 0.0f);
  const float width = (max - min) / kBins;
  const auto intervals = static_cast<std::size_t>(points.interval_count);
  std::size_t interval = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    // A bin reaches a little over its ends, so that rounding never loses a control point.
    float low = min + width * (static_cast<float>(bin) - 0.01f), high = min + width * (static_cast<float>(bin) + 1.01f);
    // Filters may leave the range of the values, by a few times its width.
    if (bin == 0) low -= 16.0f * (max - min);
    if (bin == kBins - 1) high += 16.0f * (max - min);
    while (interval > 0 && points.starts[interval] > low) --interval;
    while (interval + 1 < intervals && points.starts[interval + 1] < low) ++interval;
    float& steepness = table.steepness[static_cast<std::size_t>(bin)];
    float& extinction = table.extinction[static_cast<std::size_t>(bin)];
    for (std::size_t i = interval; i < intervals && points.starts[i] <= high; ++i) {
      const float a = std::max(low, points.starts[i]), b = std::min(high, points.starts[i + 1]);
      if (!(a <= b)) continue;
      steepness = std::max(steepness, bound_slope(points, i, a, b));
      extinction = std::max({extinction, eval_densities(points, i, a)[0], eval_densities(points, i, b)[0]});
      if (i + 1 < intervals && points.starts[i + 1] <= high) {
        const Densities below = eval_densities(points, i, b), above = eval_densities(points, i + 1, b);
        const float scale = 1e-4f * std::max(below[0], above[0]);
        for (std::size_t c = 0; c < 4; ++c)
          if (std::abs(below[c] - above[c]) > scale) steepness = kStep;
      }
    }
  }
  fill_levels(table.steepness);
  fill_levels(table.extinction);
}

}  // namespace tetravox::optics
