/// Functions of several variables and colours by another array in scene files, and what is made from the data.

#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"
#include "tests/unit/optics/expect_error.h"
#include "tests/unit/scene/scene_text.h"
#include "tetravox/analysis.h"
#include "tetravox/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace tetravox {
namespace {

using testing::expect_bad;
using testing::expect_error;
using testing::parse;

class Dice {
 public:
  double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  double number() { return (unit() - 0.5) * std::pow(10.0, 200.0 * (unit() - 0.5)); }
  int below(int end) { return static_cast<int>(unit() * end); }
  Color color() { return {unit(), unit(), unit()}; }

 private:
  std::mt19937 random_{23};
};

Variable random_array(Dice& dice, const std::string& name) {
  Variable variable{VariableKind::kArray, {name, {}, {}}, {}};
  if (dice.below(2)) variable.array.association = static_cast<Association>(dice.below(2));
  if (dice.below(2)) variable.array.component = dice.below(4) - 1;
  if (dice.below(2)) variable.range = ValueRange{-std::abs(dice.number()), 1e-200 + std::abs(dice.number())};
  return variable;
}

MultidimensionalFunction random_function(Dice& dice) {
  MultidimensionalFunction function;
  function.variables = {{}, {VariableKind::kGradient, {}, {}}};
  if (dice.below(2)) function.variables[1] = random_array(dice, "speed");
  if (dice.below(2)) function.variables.push_back(random_array(dice, "\xC3\xA4 \"b\""));
  for (int i = dice.below(4); i > 0; --i) {
    Widget widget;
    widget.shape = static_cast<WidgetShape>(dice.below(3));
    for (std::size_t axis = 0; axis < function.variables.size(); ++axis) {
      widget.center[axis] = dice.number();
      widget.radius[axis] = 1e-200 + std::abs(dice.number());
    }
    widget.color = dice.color();
    widget.opacity = dice.unit();
    function.widgets.push_back(widget);
  }
  if (function.widgets.empty()) function.table_file = "tables/t.npy";
  function.resolution = 16 + dice.below(100);
  if (dice.below(2)) function.unit_distance = 1e-100 + std::abs(dice.number());
  return function;
}

TEST(MultidimensionalScene, ComesBackAsItWas) {
  Dice dice;
  for (int i = 0; i < 200; ++i) {
    Scene scene;
    scene.data.file = "a.vtu";
    scene.multidimensional = random_function(dice);
    const std::string text = format_scene(scene);
    const Scene read = parse_scene(text, "scene.json");
    ASSERT_EQ(format_scene(read), text);
    const MultidimensionalFunction &a = *scene.multidimensional, &b = *read.multidimensional;
    ASSERT_EQ(b.variables.size(), a.variables.size());
    for (std::size_t v = 0; v < a.variables.size(); ++v) {
      EXPECT_EQ(b.variables[v].kind, a.variables[v].kind);
      EXPECT_EQ(b.variables[v].array.name, a.variables[v].array.name);
      EXPECT_EQ(b.variables[v].array.association, a.variables[v].array.association);
      EXPECT_EQ(b.variables[v].array.component, a.variables[v].array.component);
      ASSERT_EQ(b.variables[v].range.has_value(), a.variables[v].range.has_value());
      if (a.variables[v].range) {
        EXPECT_EQ(b.variables[v].range->max, a.variables[v].range->max);
      }
    }
    ASSERT_EQ(b.widgets.size(), a.widgets.size());
    for (std::size_t w = 0; w < a.widgets.size(); ++w) {
      EXPECT_EQ(b.widgets[w].shape, a.widgets[w].shape);
      EXPECT_EQ(b.widgets[w].center, a.widgets[w].center);
      EXPECT_EQ(b.widgets[w].radius[0], a.widgets[w].radius[0]);
      EXPECT_EQ(b.widgets[w].color, a.widgets[w].color);
      EXPECT_EQ(b.widgets[w].opacity, a.widgets[w].opacity);
    }
    EXPECT_EQ(b.table_file, a.table_file);
    EXPECT_EQ(b.resolution, a.resolution);
    EXPECT_EQ(b.unit_distance, a.unit_distance);
  }
}

TEST(MultidimensionalScene, ColorsComeBackAsTheyWere) {
  Scene scene;
  scene.data.file = "a.vtu";
  scene.color_by.emplace();
  scene.color_by->array = {"wave", Association::kPoint, 1};
  scene.color_by->function = make_preset("coolwarm", {{-1.0, 2.0}});
  const Scene read = parse_scene(format_scene(scene), "scene.json");
  ASSERT_TRUE(read.color_by && read.color_by->function);
  EXPECT_EQ(read.color_by->array.name, "wave");
  EXPECT_EQ(read.color_by->array.component, 1);
  ASSERT_EQ(read.color_by->function->points.size(), scene.color_by->function->points.size());
  EXPECT_EQ(read.color_by->function->points[3].color, scene.color_by->function->points[3].color);
  EXPECT_EQ(format_scene(read), format_scene(scene));
  EXPECT_FALSE(parse(R"("color_by":{"array":"T"})").color_by->function);
}

TEST(MultidimensionalScene, ArraysAreThoseOfTheVariablesThenOfColors) {
  const std::string variables =
      R"("multidimensional":{"variables":[{"kind":"array","array":"b"},{"kind":"value"},{"kind":"array","array":"a",)"
      R"("component":2}],"table":"t.npy"})";
  const std::vector<ArrayRequest> arrays = other_arrays(parse(variables));
  ASSERT_EQ(arrays.size(), 2u);
  EXPECT_EQ(arrays[0].name, "b");
  EXPECT_EQ(arrays[1].name, "a");
  EXPECT_EQ(arrays[1].component, 2);
  EXPECT_EQ(other_arrays(parse(R"("color_by":{"array":"T"})")).at(0).name, "T");
  EXPECT_TRUE(other_arrays(Scene{}).empty());
}

TEST(MultidimensionalScene, WhatIsWrongIsNamedWithItsPlace) {
  const auto bad = [](const std::string& members, const char* where, const char* what) {
    expect_bad("\"multidimensional\":{" + members + "}", where, what);
  };
  const std::string two = R"("variables":[{"kind":"value"},{"kind":"gradient"}],)";
  const std::string widget = R"({"shape":"gaussian","center":[0,0],"radius":[1,1]})";
  bad("", "multidimensional", "'variables' is missing");
  bad(R"("variables":[{"kind":"value"}],"table":"t.npy")", "multidimensional.variables", "two or three");
  bad(R"("variables":[{"kind":"value"},{"kind":"slope"}],"table":"t.npy")", "variables[1].kind", "gradient");
  bad(R"("variables":[{"kind":"value"},{"kind":"value"}],"table":"t.npy")", "multidimensional", "same");
  bad(R"("variables":[{"kind":"value"},{"kind":"array"}],"table":"t.npy")", "variables[1]", "'array' is missing");
  bad(R"("variables":[{"kind":"value"},{"kind":"gradient","array":"T"}],"table":"t.npy")", "variables[1]", "'array'");
  bad(R"("variables":[{"kind":"value","range":[2,1]},{"kind":"gradient"}],"table":"t.npy")", "multidimensional",
      "range");
  bad(two.substr(0, two.size() - 1), "multidimensional", "either 'widgets' or 'table'");
  bad(two + R"("table":"t.npy","widgets":[)" + widget + "]", "multidimensional", "either 'widgets' or 'table'");
  bad(two + R"("table":"")", "multidimensional.table", "not a file name");
  bad(two + R"("widgets":[])", "multidimensional.widgets", "1 to 1000");
  bad(two + R"("widgets":[{"shape":"gaussian","center":[0,0,0],"radius":[1,1]}])", "widgets[0].center", "2 numbers");
  bad(two + R"("widgets":[{"shape":"disc","center":[0,0],"radius":[1,1]}])", "widgets[0].shape", "rectangle");
  bad(two + R"("widgets":[{"shape":"gaussian","centre":[0,0],"radius":[1,1]}])", "widgets[0]", "did you mean 'center'");
  bad(two + R"("widgets":[{"shape":"gaussian","center":[0,0],"radius":[1,0]}])", "multidimensional", "radius");
  bad(two + R"("widgets":[)" + widget + R"(],"resolution":8)", "multidimensional", "16");
  bad(two + R"("widgets":[)" + widget + R"(],"resolution":5000)", "multidimensional.resolution", "1024");
  bad(two + R"("widgets":[)" + widget + R"(],"unit_distance":0)", "multidimensional", "unit distance");
  bad(two + R"("widgets":[)" + widget + R"(],"extent":0)", "multidimensional", "unknown key 'extent'");
  expect_bad(R"("color_by":{"function":{}})", "color_by", "'array' is missing");
  expect_bad(R"("color_by":{"array":""})", "color_by.array", "names no array");
  expect_bad(R"("color_by":{"array":"T","colour":1})", "color_by", "unknown key 'colour'");
  expect_bad("\"multidimensional\":{" + two + R"("table":"t.npy"},"color_by":{"array":"T"})", "", "of its own");
}

double radius(const Vector3& p) { return std::hypot(p[0], p[1], p[2]); }

/// A ball whose values fall from 1 to 0 at radius 0.6, and beside it the coordinate x.
PreparedMesh make_ball_mesh() {
  tests::BoxOptions options;
  options.bricks = {12, 12, 12};
  const auto ball = [](const Vector3& p) { return 1.0 / (1.0 + std::exp(20.0 * (radius(p) - 0.6))); };
  MeshData mesh = tests::make_box(options, ball);
  const MeshData x = tests::make_box(options, [](const Vector3& p) { return 10.0 * p[0]; });
  mesh.others.push_back({x.scalars, "x", 0});
  return prepare_mesh(mesh);
}

PreparedGrid make_ball_grid() {
  tests::GridOptions options;
  options.dimensions = {25, 25, 25};
  const auto ball = [](const Vector3& p) { return 1.0 / (1.0 + std::exp(20.0 * (radius(p) - 0.6))); };
  return prepare_grid(tests::make_grid(options, ball),
                      {tests::make_grid(options, [](const Vector3& p) { return 10.0 * p[0]; })});
}

template <class Prepared>
void expect_joint(const Prepared& prepared, double tolerance) {
  HistogramOptions options;
  options.bins = 2;
  options.other_bins = 4;
  const Histogram2D histogram = make_joint_histogram(prepared, 0, options);
  EXPECT_DOUBLE_EQ(histogram.other_range.min, -10.0);
  EXPECT_DOUBLE_EQ(histogram.other_range.max, 10.0);
  EXPECT_NEAR(std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0.0), 1.0, 1e-9);
  // In the upper half of the values lies the ball, of radius 0.6 in a cube of side 2; the middle two slabs of x cut it.
  const double pi = 3.14159265358979, ball = 4.0 / 3.0 * pi * 0.216 / 8.0;
  const double slab = pi * (0.36 * 0.5 - 0.125 / 3.0) / 8.0;
  EXPECT_NEAR(histogram.counts[1] + histogram.counts[3] + histogram.counts[5] + histogram.counts[7], ball, tolerance);
  EXPECT_NEAR(histogram.counts[3], slab, tolerance);
  EXPECT_NEAR(histogram.counts[5], slab, tolerance);
  EXPECT_NEAR(histogram.counts[1], 0.5 * ball - slab, tolerance);
  EXPECT_THROW(make_joint_histogram(prepared, 1, options), Error);
}

TEST(JointHistogram, CountsTheVolumeOfPairs) {
  expect_joint(make_ball_mesh(), 0.004);
  expect_joint(make_ball_grid(), 0.008);
}

TEST(VariableRanges, AreWhatOccurs) {
  const std::vector<Variable> variables{
      {}, {VariableKind::kGradient, {}, {}}, {VariableKind::kArray, {"x", {}, {}}, {}}};
  const PreparedMesh mesh = make_ball_mesh();
  const std::vector<ValueRange> ranges = make_variable_ranges(mesh, variables);
  ASSERT_EQ(ranges.size(), 3u);
  EXPECT_EQ(ranges[0].max, mesh.scalar_range.max);
  EXPECT_EQ(ranges[1].min, 0.0);
  EXPECT_EQ(ranges[1].max, make_gradient_histogram(mesh).other_range.max);
  EXPECT_DOUBLE_EQ(ranges[2].min, -10.0);
  EXPECT_THROW(make_variable_ranges(mesh, {variables[2], variables[2]}), Error);
}

TEST(DefaultFunction, IsDenseWhereGradientsAreLarge) {
  for (const MultidimensionalFunction& function :
       {make_default_multidimensional(make_ball_mesh(), {{}, {VariableKind::kGradient, {}, {}}}),
        make_default_multidimensional(make_ball_grid(), {{}, {VariableKind::kGradient, {}, {}}})}) {
    EXPECT_NO_THROW(validate_multidimensional(function));
    ASSERT_TRUE(function.variables[1].range);
    const std::vector<ValueRange> ranges(2, {0.0, 1.0});
    const OpticalTable table = make_optical_table(function, ranges, 1.0);
    const double top = function.variables[1].range->max;
    const double on = eval_optical_table(table, std::vector<double>{0.5, top}).extinction;
    EXPECT_GT(on, 20.0 * eval_optical_table(table, std::vector<double>{0.5, 0.0}).extinction);
    EXPECT_GT(on, 20.0 * eval_optical_table(table, std::vector<double>{0.98, 0.0}).extinction);
  }
}

TEST(DefaultFunction, ColorsFollowTheOtherArray) {
  const std::vector<Variable> variables{{}, {VariableKind::kArray, {"x", {}, {}}, {}}};
  const MultidimensionalFunction function = make_default_multidimensional(make_ball_mesh(), variables);
  const OpticalTable table = make_optical_table(function, std::vector<ValueRange>(2), 1.0);
  const auto at = [&](double value, double x) { return eval_optical_table(table, std::vector<double>{value, x}); };
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(at(0.9, -6.0).color[c], at(0.4, -6.0).color[c], 0.05);
  EXPECT_GT(at(0.9, 9.0).color[0], at(0.9, -9.0).color[0] + 0.2);
  const std::vector<Variable> three{variables[0], {VariableKind::kGradient, {}, {}}, variables[1]};
  const MultidimensionalFunction of_three = make_default_multidimensional(make_ball_grid(), three);
  EXPECT_NO_THROW(validate_multidimensional(of_three));
  EXPECT_EQ(of_three.widgets.size(), 64u);
}

TEST(DefaultFunction, ShowsConstantArrays) {
  tests::GridOptions options;
  const PreparedGrid grid = prepare_grid(tests::make_grid(options, [](const Vector3&) { return 5.0; }));
  const std::vector<Variable> variables{{}, {VariableKind::kGradient, {}, {}}};
  const MultidimensionalFunction function = make_default_multidimensional(grid, variables);
  EXPECT_NO_THROW(validate_multidimensional(function));
  const OpticalTable table = make_optical_table(function, make_variable_ranges(grid, variables), 1.0);
  EXPECT_GT(eval_optical_table(table, std::vector<double>{5.0, 0.0}).extinction, 0.0);
}

}  // namespace
}  // namespace tetravox
