#include "src/optics/steepness_table.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace tetravox::optics {
namespace {

OpticalPoint white(double value, double extinction) {
  OpticalPoint point;
  point.value = value;
  point.color = {1, 1, 1};
  point.extinction = extinction;
  return point;
}

SteepnessTable make_table(std::initializer_list<OpticalPoint> points, float min, float max) {
  OpticalFunction function;
  function.points = points;
  SteepnessTable table;
  build_steepness_table(build_control_point_table(function, {}), min, max, table);
  return table;
}

TEST(SteepnessTable, KnowsWhereThereIsNothingToSee) {
  const SteepnessTable table = make_table({white(0.4, 0.0), white(0.5, 2.0), white(0.6, 0.0)}, 0, 1);
  EXPECT_EQ(table.largest_extinction(0.0f, 0.39f), 0.0f);
  EXPECT_EQ(table.largest_extinction(0.61f, 1.0f), 0.0f);
  EXPECT_NEAR(table.largest_extinction(0.0f, 1.0f), 2.0f, 1e-5f);
  EXPECT_GT(table.largest_extinction(0.41f, 0.42f), 0.0f);
}

TEST(SteepnessTable, IsTheSlopeOfTheExtinction) {
  const SteepnessTable table = make_table({white(0.0, 0.0), white(0.5, 2.0), white(1.0, 2.0)}, 0, 1);
  EXPECT_NEAR(table.largest_steepness(0.1f, 0.3f), 4.0f, 1e-4f);
  EXPECT_NEAR(table.largest_steepness(0.6f, 0.9f), 0.0f, 1e-4f);
  EXPECT_NEAR(table.largest_steepness(0.1f, 0.9f), 4.0f, 1e-4f);
}

TEST(SteepnessTable, StepsAreSteep) {
  const SteepnessTable table = make_table({white(0.5, 0.0), white(0.5, 1.0)}, 0, 1);
  EXPECT_GT(table.largest_steepness(0.4f, 0.6f), 1e20f);
  EXPECT_EQ(table.largest_steepness(0.0f, 0.3f), 0.0f);
}

TEST(SteepnessTable, OneValueIsARange) {
  const SteepnessTable table = make_table({white(0.0, 3.0)}, 2.0f, 2.0f);
  EXPECT_EQ(table.largest_extinction(2.0f, 2.0f), 3.0f);
}

}  // namespace
}  // namespace tetravox::optics
