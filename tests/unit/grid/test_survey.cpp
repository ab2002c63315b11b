/// Ranges and missing values of every number type.

#include "src/grid/survey.h"
#include "src/support/threads.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetravox::grid {
namespace {

/// A grid of n x 3 x 2 points over values that live as long as they are viewed.
template <class T>
GridData view(const std::vector<T>& values, ScalarType type, int components = 1) {
  GridData grid;
  grid.shape.dimensions = {static_cast<std::uint32_t>(values.size() / 6 / static_cast<std::size_t>(components)), 3, 2};
  grid.type = type;
  grid.components = components;
  grid.values = std::as_bytes(std::span(values));
  grid.array_name = "values";
  return grid;
}

template <class T>
void expect_range(ScalarType type) {
  for (const std::size_t count : {12, 30, 600, 600'000}) {
    std::vector<T> values(count, T{7});
    values[count / 3] = std::numeric_limits<T>::lowest();
    values[count - 1] = std::numeric_limits<T>::max();
    const ArrayInfo info = describe_values(view(values, type));
    EXPECT_EQ(info.type, scalar_type_name(type));
    EXPECT_EQ(info.component_ranges.at(0).min, static_cast<double>(std::numeric_limits<T>::lowest()));
    EXPECT_EQ(info.component_ranges.at(0).max, static_cast<double>(std::numeric_limits<T>::max()));
    EXPECT_EQ(info.nan_count, 0u);
  }
}

TEST(Survey, EveryNumberType) {
  expect_range<std::int8_t>(ScalarType::kInt8);
  expect_range<std::uint8_t>(ScalarType::kUint8);
  expect_range<std::int16_t>(ScalarType::kInt16);
  expect_range<std::uint16_t>(ScalarType::kUint16);
  expect_range<std::int32_t>(ScalarType::kInt32);
  expect_range<std::uint32_t>(ScalarType::kUint32);
  expect_range<std::int64_t>(ScalarType::kInt64);
  expect_range<std::uint64_t>(ScalarType::kUint64);
  expect_range<float>(ScalarType::kFloat32);
  expect_range<double>(ScalarType::kFloat64);
}

TEST(Survey, WhatIsNotFiniteIsCountedAndLeftOut) {
  std::vector<float> values(60'000, 2.0f);
  for (std::size_t i = 0; i < values.size(); i += 7)
    values[i] = i % 2 == 0 ? std::nanf("") : std::numeric_limits<float>::infinity();
  values[1] = -3.0f;
  const ValueSurvey survey = survey_values(view(values, ScalarType::kFloat32));
  EXPECT_EQ(survey.range.min, -3.0);
  EXPECT_EQ(survey.range.max, 2.0);
  EXPECT_EQ(survey.missing, (values.size() + 6) / 7);
  const std::vector<float> nothing(600, -std::numeric_limits<float>::infinity());
  EXPECT_GT(survey_values(view(nothing, ScalarType::kFloat32)).range.min, 0.0);
  const ArrayInfo info = describe_values(view(nothing, ScalarType::kFloat32));
  EXPECT_EQ(info.nan_count, 600u);
  EXPECT_EQ(info.component_ranges.at(0).min, 0.0);
  EXPECT_EQ(info.component_ranges.at(0).max, 0.0);
}

TEST(Survey, ComponentsAndMagnitude) {
  std::vector<double> values(3 * 6000);
  for (std::size_t i = 0; i < 6000; ++i) {
    values[3 * i] = static_cast<double>(i) + 1;
    values[3 * i + 1] = -5.0;
    values[3 * i + 2] = i == 10 ? std::nan("") : 0.0;
  }
  const ArrayInfo info = describe_values(view(values, ScalarType::kFloat64, 3));
  EXPECT_EQ(info.components, 3);
  ASSERT_EQ(info.component_ranges.size(), 3u);
  EXPECT_EQ(info.component_ranges[0].min, 1.0);
  EXPECT_EQ(info.component_ranges[0].max, 6000.0);
  EXPECT_EQ(info.component_ranges[1].min, -5.0);
  EXPECT_EQ(info.component_ranges[1].max, -5.0);
  EXPECT_DOUBLE_EQ(info.magnitude_range.min, std::sqrt(26.0));
  EXPECT_DOUBLE_EQ(info.magnitude_range.max, std::hypot(6000.0, 5.0));
  EXPECT_EQ(info.nan_count, 1u);
}

TEST(Survey, DescribesTheLattice) {
  const std::vector<std::uint8_t> values(24, 1);
  GridData grid = view(values, ScalarType::kUint8);  // 4 x 3 x 2
  grid.shape.origin = {1, 2, 3};
  grid.shape.spacing = {1, 0.5, 2};
  grid.shape.direction = {0, -1, 0, 1, 0, 0, 0, 0, 1};  // Axis i points along y, axis j against x.
  DatasetInfo info;
  describe_grid(grid, info);
  EXPECT_EQ(info.point_count, 24u);
  EXPECT_EQ(info.cell_count, 6u);
  EXPECT_EQ(info.bounds[0].min, 0.0);
  EXPECT_EQ(info.bounds[0].max, 1.0);
  EXPECT_EQ(info.bounds[1].min, 2.0);
  EXPECT_EQ(info.bounds[1].max, 5.0);
  EXPECT_EQ(info.bounds[2].max, 5.0);
  ASSERT_TRUE(info.grid.has_value());
  EXPECT_EQ(info.arrays.at(0).name, "values");
}

}  // namespace
}  // namespace tetravox::grid
