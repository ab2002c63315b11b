#include "src/optics/antiderivative_table.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tetravox::optics {
namespace {

const OpticalFunction kFunction{
    {{-1.0, 0.5, {0, 0, 1}}, {0.0, 1.5, {0, 1, 0}}, {0.0, 4.0, {1, 1, 0}}, {2.0, 0.0, {1, 0, 0}}}};

/// As the kernels do it: the bucket's interval, then on until the next one starts beyond.
std::int32_t find_interval(const ControlPointTable& table, float scalar) {
  const float at = (scalar - table.first) * table.buckets_per_scalar;
  const auto bucket =
      static_cast<std::size_t>(std::clamp(at, 0.0f, static_cast<float>(table.first_interval.size() - 1)));
  std::int32_t interval = table.first_interval[bucket];
  EXPECT_LE(table.starts[interval], scalar) << "the search only goes up";
  while (table.starts[interval + 1] <= scalar) ++interval;
  return interval;
}

TEST(ControlPointTable, EvaluatesTheFunctionEverywhere) {
  const ScalarMap map{0.25, 2.0};
  const ControlPointTable table = build_control_point_table(kFunction, map);
  for (double value = -2.0; value < 3.0; value += 0.0137) {
    const float scalar = map.stored_from_value(value);
    const std::int32_t i = find_interval(table, scalar);
    const OpticalPoint expected = eval_optical_function(kFunction, value);
    const float x = scalar - table.references[i];
    EXPECT_NEAR(table.densities_front[i][0] + table.slopes[i][0] * x, expected.extinction, 1e-5) << value;
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(table.densities_front[i][channel + 1] + table.slopes[i][channel + 1] * x, expected.color[channel],
                  1e-5);
  }
}

TEST(ControlPointTable, AStepBelongsToItsUpperSide) {
  const ControlPointTable table = build_control_point_table(kFunction, {});
  EXPECT_EQ(table.densities_front[find_interval(table, 0.0f)][0], 4.0f);
}

TEST(ControlPointTable, OnePointIsAConstant) {
  const ControlPointTable table = build_control_point_table({{{0.5, 2.0, {1, 1, 1}}}}, {});
  for (const float scalar : {-10.0f, 0.5f, 10.0f})
    EXPECT_EQ(table.densities_front[find_interval(table, scalar)][0], 2.0f);
}

}  // namespace
}  // namespace tetravox::optics
