#include "src/optics/iso_value_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tetravox::optics {
namespace {

OpticalFunction make_function(const std::vector<double>& values) {
  OpticalFunction function;
  for (const double value : values) function.points.push_back({value, 1.0 + value, {0.5, 0.5, 0.5}});
  return function;
}

/// Where a ray sets out, found by looking at all control points.
std::int32_t expected_interval(const ControlPointTable& points, float front, bool rises) {
  std::int32_t interval = 0;
  for (std::int32_t i = 1; i < points.interval_count; ++i)
    interval += rises ? points.starts[i] <= front : points.starts[i] < front;
  return interval;
}

void expect_right(const std::vector<double>& values, const std::vector<float>& scalars) {
  const ControlPointTable points = build_control_point_table(make_function(values), {});
  const IsoValueTable table = build_iso_value_table(points);
  const auto texel_of = [&](float s) {
    return std::floor(std::clamp((s - table.first) * table.texels_per_scalar, 0.0f, IsoValueTable::kSize - 1.0f));
  };
  for (const float front : scalars)
    for (const float back : scalars) {
      if (back < front && texel_of(front) == texel_of(back)) continue;  // taken as rising
      EXPECT_EQ(find_front_interval(table, front, back), expected_interval(points, front, back >= front))
          << front << " to " << back;
    }
}

TEST(IsoValueTable, FindsTheIntervalOfAnySegment) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-0.2f, 1.2f);
  std::vector<float> scalars;
  for (int i = 0; i < 300; ++i) scalars.push_back(any(random));
  expect_right({0.0, 0.13, 0.5, 0.71, 1.0}, scalars);
}

TEST(IsoValueTable, RaysThatSetOutFromAnIsoValueGoOnFromThere) {
  expect_right({0.0, 0.25, 0.5, 1.0}, {0.0f, 0.25f, 0.5f, 1.0f, 0.1f, 0.3f, 0.9f, -1.0f, 2.0f});
}

TEST(IsoValueTable, StepsAreTwoIsoValuesAtOnce) {
  expect_right({0.0, 0.4, 0.4, 1.0}, {0.0f, 0.4f, 0.39f, 0.41f, 1.0f});
}

TEST(IsoValueTable, OneControlPointIsEnough) { expect_right({0.5}, {0.0f, 0.5f, 1.0f}); }

}  // namespace
}  // namespace tetravox::optics
