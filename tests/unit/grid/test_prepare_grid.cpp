#include "src/grid/frame.h"
#include "tetravox/error.h"
#include "tetravox/grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetravox {
namespace {

template <class T>
GridData view(const std::vector<T>& values, ScalarType type, std::array<std::uint32_t, 3> dimensions) {
  GridData grid;
  grid.shape.dimensions = dimensions;
  grid.type = type;
  grid.values = std::as_bytes(std::span<const T>(values));
  grid.array_name = "values";
  return grid;
}

std::vector<float> make_values(std::array<std::uint32_t, 3> dimensions, float (*field)(float, float, float)) {
  std::vector<float> values;
  for (std::uint32_t k = 0; k < dimensions[2]; ++k)
    for (std::uint32_t j = 0; j < dimensions[1]; ++j)
      for (std::uint32_t i = 0; i < dimensions[0]; ++i)
        values.push_back(field(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)));
  return values;
}

TEST(PrepareGrid, LinearFieldsAreCoarseWithoutError) {
  const std::array<std::uint32_t, 3> dimensions{17, 17, 9};
  const auto values = make_values(dimensions, [](float x, float y, float z) { return 2 * x - y + 3 * z; });
  const PreparedGrid grid = prepare_grid(view(values, ScalarType::kFloat32, dimensions));
  ASSERT_EQ(grid.bricks.counts, (std::array<std::uint32_t, 3>{2, 2, 1}));
  for (const auto& level : grid.bricks.deviation)
    for (const float deviation : level) EXPECT_NEAR(deviation, 0.0f, 1e-6f);
}

TEST(PrepareGrid, BendOfAProductIsAQuarter) {
  const std::array<std::uint32_t, 3> dimensions{9, 9, 9};
  const auto values = make_values(dimensions, [](float x, float y, float) { return x * y; });
  const PreparedGrid grid = prepare_grid(view(values, ScalarType::kFloat32, dimensions));
  EXPECT_NEAR(grid.bricks.deviation[0][0] * static_cast<float>(grid.scalar_scale), 0.25f, 1e-5f);
  EXPECT_NEAR(grid.bricks.deviation[1][0] * static_cast<float>(grid.scalar_scale), 1.0f, 1e-5f);
}

TEST(PrepareGrid, BricksThatAreNotWholeAreNotCoarsened) {
  const std::array<std::uint32_t, 3> dimensions{12, 9, 9};
  const auto values = make_values(dimensions, [](float x, float, float) { return x; });
  const PreparedGrid grid = prepare_grid(view(values, ScalarType::kFloat32, dimensions));
  ASSERT_EQ(grid.bricks.count(), 2u);
  EXPECT_TRUE(std::isinf(grid.bricks.deviation[3][1]));
  EXPECT_EQ(grid.bricks.deviation[3][0], 0.0f);
}

TEST(PrepareGrid, RangesOfBricksAreThoseOfTheirValues) {
  const std::array<std::uint32_t, 3> dimensions{17, 2, 2};
  std::vector<std::uint8_t> values(17 * 4, 10);
  values[12] = 200;
  const PreparedGrid grid = prepare_grid(view(values, ScalarType::kUint8, dimensions));
  const auto value = [&](float stored) { return grid.scalar_offset + static_cast<double>(stored) * grid.scalar_scale; };
  EXPECT_DOUBLE_EQ(value(grid.bricks.max[0]), 10.0);
  EXPECT_DOUBLE_EQ(value(grid.bricks.max[1]), 200.0);
  EXPECT_DOUBLE_EQ(grid.scalar_range.min, 10.0);
}

TEST(PrepareGrid, ValuesThatAreNotFiniteAreMissing) {
  std::vector<double> values(8, 1.0);
  values[0] = std::numeric_limits<double>::infinity();
  values[3] = std::numeric_limits<double>::quiet_NaN();
  const PreparedGrid grid = prepare_grid(view(values, ScalarType::kFloat64, {2, 2, 2}));
  EXPECT_EQ(grid.missing_values, 2u);
  EXPECT_EQ(grid.bricks.has_missing[0], 1);
  std::fill(values.begin(), values.end(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(prepare_grid(view(values, ScalarType::kFloat64, {2, 2, 2})), Error);
}

TEST(PrepareGrid, RefusesShapesThatMakeNoSense) {
  const std::vector<std::uint8_t> values(8, 1);
  const GridData good = view(values, ScalarType::kUint8, {2, 2, 2});
  const auto expect_refused = [&](auto change) {
    GridData grid = good;
    change(grid);
    EXPECT_THROW(prepare_grid(grid), Error);
  };
  EXPECT_NO_THROW(prepare_grid(good));
  expect_refused([](GridData& grid) { grid.shape.dimensions = {2, 4, 1}; });
  expect_refused([](GridData& grid) { grid.shape.dimensions = {2, 2, 3}; });
  expect_refused([](GridData& grid) { grid.shape.spacing[1] = 0.0; });
  expect_refused([](GridData& grid) { grid.shape.origin[2] = HUGE_VAL; });
  expect_refused([](GridData& grid) { grid.shape.direction = {}; });
  expect_refused([](GridData& grid) { grid.shape.coordinates[0] = {1.0, 0.0}; });
  expect_refused([](GridData& grid) { grid.shape.coordinates[0] = {1.0}; });
  expect_refused([](GridData& grid) { grid.components = 5; });
  expect_refused([](GridData& grid) { grid.component = 1; });
}

TEST(PrepareGrid, FurtherFieldsHaveTheShapeOfTheFirst) {
  const std::array<std::uint32_t, 3> dimensions{9, 4, 3};
  const auto rising = make_values(dimensions, [](float x, float, float) { return x; });
  const auto falling = make_values(dimensions, [](float x, float y, float) { return 100.0f - x * y; });
  const GridData first = view(rising, ScalarType::kFloat32, dimensions);
  GridData other = view(falling, ScalarType::kFloat32, dimensions);
  const PreparedGrid grid = prepare_grid(first, {other, first});
  ASSERT_EQ(grid.others.size(), 2u);
  EXPECT_EQ(grid.scalar_range.max, 8.0);
  EXPECT_EQ(grid.others[0].scalar_range.min, 100.0 - 8.0 * 3.0);
  EXPECT_EQ(grid.others[0].bricks.count(), grid.bricks.count());
  EXPECT_EQ(grid.others[1].scalar_range.max, 8.0);
  other.shape.spacing[1] = 2.0;
  EXPECT_THROW(prepare_grid(first, {other}), Error);
}

TEST(GridFrame, UnevenAxesKeepTheirEnds) {
  GridShape shape;
  shape.dimensions = {4, 2, 2};
  shape.coordinates[0] = {10.0, 11.0, 13.0, 16.0};
  const grid::GridFrame frame = grid::make_grid_frame(shape);
  EXPECT_FLOAT_EQ(frame.plane(0, 0), 0.0f);
  EXPECT_FLOAT_EQ(frame.plane(0, 1), 0.5f);
  EXPECT_FLOAT_EQ(frame.plane(0, 3), 3.0f);
  EXPECT_FLOAT_EQ(frame.plane(1, 1), 1.0f);
  const auto bounds = grid::bounds_of(shape);
  EXPECT_DOUBLE_EQ(bounds[0].min, 10.0);
  EXPECT_DOUBLE_EQ(bounds[0].max, 16.0);
}

}  // namespace
}  // namespace tetravox
