#include "src/optics/iso_value_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::optics {
namespace {

int texel_of(const IsoValueTable& table, float scalar) {
  const float at = (scalar - table.first) * table.texels_per_scalar;
  return static_cast<int>(std::min(std::max(at, 0.0f), static_cast<float>(IsoValueTable::kSize - 1)));
}

/// What segments that set out in a texel meet. Interval i ends where control point i is, and i + 1 starts there.
std::array<float, 4> find_texel(const ControlPointTable& points, float low, float high, bool rises) {
  const auto begin = points.starts.begin() + 1, end = points.starts.begin() + points.interval_count;  // finite ones
  const auto value = [&](std::ptrdiff_t i) {
    if (i < 0) return -std::numeric_limits<float>::infinity();
    return i < end - begin ? begin[i] : std::numeric_limits<float>::infinity();
  };
  if (rises) {
    const std::ptrdiff_t i = std::lower_bound(begin, end, low) - begin;
    return {value(i), value(i + 1), static_cast<float>(i), 0.0f};
  }
  const std::ptrdiff_t i = std::upper_bound(begin, end, high) - begin - 1;
  return {value(i), value(i - 1), static_cast<float>(i + 1), 0.0f};
}

}  // namespace

IsoValueTable build_iso_value_table(const ControlPointTable& points) {
  constexpr int kSize = IsoValueTable::kSize;
  IsoValueTable table;
  const bool has_points = points.interval_count > 1;
  const float first = has_points ? points.starts[1] : 0.0f;
  const float last = has_points ? points.starts[static_cast<std::size_t>(points.interval_count) - 1] : 0.0f;
  table.first = first;
  table.texels_per_scalar = last > first ? kSize / (last - first) : 0.0f;
  table.texels.resize(static_cast<std::size_t>(kSize) * kSize);
  for (int front = 0; front < kSize; ++front) {
    // A little wider than the texel, so that rounding puts no scalar outside; everything that lies beyond the ends.
    const float infinite = std::numeric_limits<float>::infinity();
    const float width = table.texels_per_scalar > 0.0f ? 1.0f / table.texels_per_scalar : infinite;
    const float low = front == 0 ? -infinite : first + (static_cast<float>(front) - 0.01f) * width;
    const float high = front == kSize - 1 ? infinite : first + (static_cast<float>(front) + 1.01f) * width;
    const std::array<float, 4> rising = find_texel(points, low, high, true);
    const std::array<float, 4> falling = find_texel(points, low, high, false);
    for (int back = 0; back < kSize; ++back)
      table.texels[static_cast<std::size_t>(back) * kSize + static_cast<std::size_t>(front)] =
          back < front ? falling : rising;
  }
  return table;
}

std::int32_t find_front_interval(const IsoValueTable& table, float front, float back) {
  const int i = texel_of(table, front), j = texel_of(table, back);
  const std::array<float, 4>& texel =
      table.texels[static_cast<std::size_t>(j) * IsoValueTable::kSize + static_cast<std::size_t>(i)];
  const auto interval = static_cast<std::int32_t>(texel[2]);
  if (j < i) return interval - (front <= texel[0]) - (front <= texel[1]);
  return interval + (front >= texel[0]) + (front >= texel[1]);
}

}  // namespace tetravox::optics
