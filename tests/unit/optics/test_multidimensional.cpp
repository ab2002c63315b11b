#include "tests/unit/optics/expect_error.h"
#include "tetravox/multidimensional.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace tetravox {
namespace {

using testing::expect_error;

const std::array<ValueRange, 2> kRanges{{{0, 1}, {0, 2}}};

MultidimensionalFunction make_function() {
  MultidimensionalFunction function;
  function.variables = {{VariableKind::kValue, {}, {}}, {VariableKind::kGradient, {}, {}}};
  function.resolution = 101;
  function.unit_distance = 2.0;
  return function;
}

double extinction_of(double opacity, double unit_distance = 2.0) { return -std::log1p(-opacity) / unit_distance; }

OpticalPoint eval(const OpticalTable& table, double x, double y) { return eval_optical_table(table, std::array{x, y}); }

TEST(Multidimensional, WidgetsHaveTheirShapes) {
  MultidimensionalFunction function = make_function();
  const Color color{0.2, 0.4, 0.6};
  function.widgets = {{WidgetShape::kRectangle, {0.5, 1.0, 0}, {0.2, 0.4, 1}, color, 0.8}};
  OpticalTable table = make_optical_table(function, kRanges, 9.0);
  EXPECT_EQ(table.sizes, (std::vector<std::size_t>{101, 101}));
  EXPECT_NEAR(eval(table, 0.5, 1.0).extinction, extinction_of(0.8), 1e-12);
  EXPECT_NEAR(eval(table, 0.32, 1.36).extinction, extinction_of(0.8), 1e-12);
  EXPECT_EQ(eval(table, 0.28, 1.0).extinction, 0.0);
  EXPECT_EQ(eval(table, 0.5, 1.46).extinction, 0.0);
  // What is interpolated towards has the colour, too.
  for (const OpticalPoint& entry : table.entries)
    for (int channel = 0; channel < 3; ++channel) ASSERT_NEAR(entry.color[channel], color[channel], 1e-12);

  function.widgets[0].shape = WidgetShape::kGaussian;
  table = make_optical_table(function, kRanges, 9.0);
  EXPECT_NEAR(eval(table, 0.5, 1.0).extinction, extinction_of(0.8), 1e-12);
  EXPECT_NEAR(eval(table, 0.7, 1.0).extinction, extinction_of(0.8 * std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(eval(table, 0.6, 1.2).extinction, extinction_of(0.8 * std::exp(-0.5)), 1e-12);

  // Apex at 0.6, as wide as the radius at 1.4.
  function.widgets[0].shape = WidgetShape::kTriangle;
  table = make_optical_table(function, kRanges, 9.0);
  EXPECT_EQ(eval(table, 0.5, 0.58).extinction, 0.0);
  EXPECT_NEAR(eval(table, 0.5, 1.0).extinction, extinction_of(0.8), 1e-12);
  EXPECT_NEAR(eval(table, 0.55, 1.0).extinction, extinction_of(0.4), 1e-12);
  EXPECT_NEAR(eval(table, 0.6, 1.4).extinction, extinction_of(0.4), 1e-12);
  EXPECT_EQ(eval(table, 0.61, 1.0).extinction, 0.0);
  EXPECT_EQ(eval(table, 0.5, 1.42).extinction, 0.0);
}

TEST(Multidimensional, ExtinctionsOfWidgetsAddUpAndMixTheirColours) {
  MultidimensionalFunction function = make_function();
  function.widgets = {{WidgetShape::kRectangle, {0.4, 1.0, 0}, {0.2, 0.4, 1}, {1, 0, 0}, 0.5},
                      {WidgetShape::kRectangle, {0.6, 1.0, 0}, {0.2, 0.4, 1}, {0, 1, 0}, 0.75}};
  const OpticalTable table = make_optical_table(function, kRanges, 9.0);
  const OpticalPoint both = eval(table, 0.5, 1.0);
  EXPECT_NEAR(both.extinction, extinction_of(0.5) + extinction_of(0.75), 1e-12);
  EXPECT_NEAR(both.color[0], 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(both.color[1], 2.0 / 3.0, 1e-12);
}

TEST(Multidimensional, ThreeVariablesHaveThreeAxes) {
  MultidimensionalFunction function = make_function();
  function.variables.push_back({VariableKind::kArray, {"third", {}, {}}, ValueRange{-1, 1}});
  function.resolution = 17;
  function.unit_distance = {};
  function.widgets = {{WidgetShape::kGaussian, {0.5, 1.0, -0.5}, {1, 2, 0.5}, {1, 1, 1}, 1.0}};
  const std::array<ValueRange, 3> ranges{{{0, 1}, {0, 2}, {7, 8}}};
  const OpticalTable table = make_optical_table(function, ranges, 3.0);
  EXPECT_EQ(table.entries.size(), 17u * 17u * 17u);
  EXPECT_EQ(table.variables[2].range->min, -1.0);
  EXPECT_NEAR(eval_optical_table(table, std::array{0.5, 1.0, -0.5}).extinction, extinction_of(kLargestOpacity, 3.0),
              1e-12);
  EXPECT_NEAR(eval_optical_table(table, std::array{1.0, 1.0, 0.0}).extinction, extinction_of(std::exp(-1.25), 3.0),
              1e-12);
}

TEST(Multidimensional, ARangeWithoutWidthIsWidened) {
  MultidimensionalFunction function = make_function();
  function.widgets.resize(1);
  const std::array<ValueRange, 2> ranges{{{3, 3}, {0, 2}}};
  const OpticalTable table = make_optical_table(function, ranges, 1.0);
  EXPECT_LT(table.variables[0].range->min, 3.0);
  EXPECT_GT(table.variables[0].range->max, 3.0);
}

TEST(Multidimensional, TablesOfColoursBecomeExtinctions) {
  MultidimensionalFunction function = make_function();
  const std::array<std::size_t, 2> sizes{2, 3};
  const std::vector<float> rgba{0, 0, 0, 0.0f, 1, 0, 0, 0.5f, 0, 1, 0, 0.25f, 0, 0, 1, 1.0f, 1, 1, 1, 0.5f, 0, 0, 0, 0};
  const OpticalTable table = make_optical_table(function, kRanges, 1.0, sizes, rgba);
  ASSERT_EQ(table.entries.size(), 6u);
  EXPECT_EQ(table.entries[0].extinction, 0.0);
  EXPECT_NEAR(table.entries[1].extinction, extinction_of(0.5), 1e-12);
  EXPECT_NEAR(table.entries[3].extinction, extinction_of(kLargestOpacity), 1e-12);
  EXPECT_EQ(table.entries[2].color, (Color{0, 1, 0}));
  // Linear between entries, clamped outside.
  EXPECT_NEAR(eval(table, 0.5, 0.0).extinction, 0.5 * extinction_of(0.5), 1e-12);
  EXPECT_NEAR(eval(table, 7.0, -3.0).extinction, extinction_of(0.5), 1e-12);
  EXPECT_NEAR(eval(table, 0.0, 1.5).color[0], 0.5, 1e-12);

  expect_error(
      ErrorCode::kInvalidArgument,
      [&] {
        make_optical_table(function, kRanges, 1.0, std::array<std::size_t, 2>{3, 3}, rgba);
      },
      "6", "9");
  expect_error(
      ErrorCode::kInvalidArgument,
      [&] {
        make_optical_table(function, kRanges, 1.0, std::array<std::size_t, 2>{1, 6}, rgba);
      },
      "axis 0");
  std::vector<float> bright = rgba;
  bright[5] = 1.5f;
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_optical_table(function, kRanges, 1.0, sizes, bright); }, "entry 1");
}

TEST(Multidimensional, WhatMakesNoSenseIsSaid) {
  const auto expect_invalid = [](const auto& change, const std::string& word) {
    MultidimensionalFunction function = make_function();
    function.widgets.resize(2);
    change(function);
    expect_error(
        ErrorCode::kInvalidArgument, [&] { make_optical_table(function, kRanges, 1.0); }, word);
  };
  using Function = MultidimensionalFunction;
  expect_invalid([](Function& f) { f.variables.pop_back(); }, "two or three");
  expect_invalid([](Function& f) { f.variables[1].kind = VariableKind::kValue; }, "same");
  expect_invalid([](Function& f) { f.variables[1].range = ValueRange{2, 1}; }, "variable 1");
  expect_invalid([](Function& f) { f.widgets.clear(); }, "widgets");
  expect_invalid([](Function& f) { f.table_file = "a.png"; }, "not both");
  expect_invalid([](Function& f) { f.resolution = 15; }, "resolution");
  expect_invalid([](Function& f) { f.resolution = 1025; }, "resolution");
  expect_invalid([](Function& f) { f.unit_distance = 0.0; }, "unit distance");
  expect_invalid([](Function& f) { f.widgets[1].radius[1] = 0.0; }, "widget 1");
  expect_invalid([](Function& f) { f.widgets[1].center[0] = std::numeric_limits<double>::quiet_NaN(); }, "widget 1");
  expect_invalid([](Function& f) { f.widgets[0].opacity = 1.1; }, "opacity");
  expect_invalid([](Function& f) { f.widgets[0].color[2] = -0.1; }, "colours");
  MultidimensionalFunction function = make_function();
  function.widgets.resize(1);
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_optical_table(function, std::span(kRanges).first(1), 1.0); }, "ranges");
}

}  // namespace
}  // namespace tetravox
