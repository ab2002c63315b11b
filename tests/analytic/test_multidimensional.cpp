/// Functions of several variables, and colour from another array than opacity, against integrals in double precision
/// and against pictures of one variable.

#include "tests/analytic/light_model.h"
#include "tests/analytic/several_fields.h"
#include "tests/analytic/show.h"
#include "tests/common/image_compare.h"
#include "tetravox/error.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

namespace tetravox::analytic {
namespace {

double linear_field(const Vector3& p) { return 0.5 + 0.2 * p[0] + 0.15 * p[1] - 0.1 * p[2]; }
const Vector3 kSlope{0.2, 0.15, -0.1};
double second_field(const Vector3& p) { return 0.5 - 0.13 * p[0] + 0.21 * p[1] + 0.15 * p[2]; }
double third_field(const Vector3& p) { return 0.5 + 0.11 * p[0] + 0.07 * p[1] + 0.3 * p[2]; }
double curved_field(const Vector3& p) { return 0.5 + 0.3 * std::sin(2.1 * p[0] + p[1]) * std::cos(1.7 * p[2]); }

Variable variable(VariableKind kind, ValueRange range = {0, 1}) { return {kind, {}, range}; }
const Variable kValue = variable(VariableKind::kValue);
const Variable kArray = variable(VariableKind::kArray);

/// A table whose entries are `eval` at their places.
OpticalTable make_table(const std::vector<Variable>& variables, const std::vector<std::size_t>& sizes,
                        const std::function<OpticalPoint(const std::array<double, 3>&)>& eval) {
  OpticalTable table{variables, sizes, {}};
  std::size_t count = 1;
  for (const std::size_t size : sizes) count *= size;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> place{};
    std::size_t rest = i;
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
      const ValueRange& range = *variables[axis].range;
      place[axis] = std::lerp(range.min, range.max,
                              static_cast<double>(rest % sizes[axis]) / static_cast<double>(sizes[axis] - 1));
      rest /= sizes[axis];
    }
    table.entries.push_back(eval(place));
  }
  return table;
}

/// Random entries between 0 and 1, `size` of them.
OpticalFunction make_bumpy_function(std::size_t size) {
  std::mt19937 random(7);
  const auto draw = [&] { return static_cast<double>(random()) / 4294967295.0; };
  OpticalFunction function;
  for (std::size_t i = 0; i < size; ++i)
    function.points.push_back(
        {static_cast<double>(i) / static_cast<double>(size - 1), 2.0 * draw(), {draw(), draw(), draw()}});
  return function;
}

/// Smooth, and dependent on all of its variables.
OpticalPoint eval_smooth(const std::array<double, 3>& p) {
  return {0.0,
          1.5 + std::sin(5.0 * p[0] + 3.0 * p[1] - 2.0 * p[2]),
          {0.5 + 0.5 * std::sin(4.0 * p[0] - 2.0 * p[1]), p[1], 0.3 + 0.7 * p[2] * p[0]}};
}

/// Grids and meshes.
class Multidimensional : public ::testing::TestWithParam<bool> {
 protected:
  static bool is_grid() { return GetParam(); }
  static SeveralFields cube(int cells, const tests::Field& value, const std::vector<tests::Field>& others) {
    return {is_grid(), cells, value, others};
  }
  static RenderSettings make_settings(double tolerance = 1e-7) {
    RenderSettings settings = make_careful_settings(Integrator::kAntiderivative);
    settings.tolerance = tolerance;
    return settings;
  }
  static RenderSettings one_dimensional(RenderSettings settings) {
    settings.integrator = Integrator::kPartial;
    return settings;
  }
  /// From all standard cameras, against emission and absorption of `eval(place)` along the ray's part in the cube.
  static void expect_integral(const std::function<Image(const Camera&)>& draw,
                              const std::function<OpticalPoint(const Vector3&)>& eval, const Tolerance& tolerance) {
    for (const auto& [name, camera] : standard_cameras())
      EXPECT_TRUE(shows(
          draw(camera), camera,
          [&](const Ray& ray) {
            const Chord chord = intersect_box(ray, kLower, kUpper);
            if (chord.length() == 0.0) return Rgba{};
            return integrate(chord.length(), [&](double u) {
              const OpticalPoint point = eval(ray.at(chord.near + u * chord.length()));
              return Medium{point.extinction, point.color};
            });
          },
          tolerance))
          << name;
  }
  static void expect_table_integral(const SeveralFields& body, const OpticalTable& table,
                                    const std::vector<tests::Field>& fields, const Tolerance& tolerance) {
    expect_integral([&](const Camera& camera) { return body.draw(table, camera, make_settings()); },
                    [&](const Vector3& place) {
                      std::vector<double> at;
                      for (const tests::Field& field : fields) at.push_back(field(place));
                      return eval_optical_table(table, at);
                    },
                    tolerance);
  }
  static void expect_same_pictures(const SeveralFields& body, const OpticalTable& table,
                                   const OpticalFunction& function, const RenderSettings& settings, double bound) {
    for (const auto& [name, camera] : standard_cameras()) {
      const Image image = body.draw(table, camera, settings);
      EXPECT_TRUE(tests::images_agree(image, body.draw(function, camera, one_dimensional(settings)), bound)) << name;
      EXPECT_GT(tests::count_covered(image), image.pixels.size() / 40) << name;
    }
  }
};

// ---- what does not depend on the second variable ----

TEST_P(Multidimensional, WithoutTheSecondVariableIsThePictureOfOne) {
  const OpticalFunction function = make_bumpy_function(48);
  const auto by_value = [&](const std::array<double, 3>& p) { return eval_optical_function(function, p[0]); };
  for (const tests::Field& field : {tests::Field(linear_field), tests::Field(curved_field)}) {
    const SeveralFields body = cube(11, field, {second_field, third_field});
    const Variable gradient = variable(VariableKind::kGradient, {0, 2});
    expect_same_pictures(body, make_table({kValue, kArray}, {48, 17}, by_value), function, make_settings(), 1e-5);
    expect_same_pictures(body, make_table({kValue, gradient}, {48, 33}, by_value), function, make_settings(), 1e-5);
    expect_same_pictures(body, make_table({kValue, kArray, gradient}, {48, 16, 20}, by_value), function,
                         make_settings(), 1e-5);
    expect_same_pictures(
        body,
        make_table({kArray, kValue}, {17, 48},
                   [&](const std::array<double, 3>& p) { return eval_optical_function(function, p[1]); }),
        function, make_settings(), 1e-5);
  }
}

TEST_P(Multidimensional, WhatTheSecondVariableNeverReachesDoesNotCount) {
  // The table depends on it, but not where the data lie: nothing can be taken for granted.
  const OpticalFunction function = make_bumpy_function(48);
  const auto eval = [&](const std::array<double, 3>& p) {
    return p[1] > 1.05 ? OpticalPoint{0.0, 9.0 * p[1], {0, 0, 0}} : eval_optical_function(function, p[0]);
  };
  const SeveralFields body = cube(11, curved_field, {second_field});
  expect_same_pictures(body, make_table({kValue, variable(VariableKind::kArray, {-1, 4})}, {48, 101}, eval), function,
                       make_settings(), 1e-5);
  expect_same_pictures(body, make_table({kValue, variable(VariableKind::kGradient, {0, 4})}, {48, 81}, eval), function,
                       make_settings(), 1e-5);
}

TEST_P(Multidimensional, WithoutTheSecondVariableLightIsThatOfOne) {
  const OpticalFunction function = make_bumpy_function(48);
  const OpticalTable table = make_table({kValue, kArray}, {48, 17}, [&](const std::array<double, 3>& p) {
    return eval_optical_function(function, p[0]);
  });
  // One normal everywhere: it does not matter where a stretch is lit.
  RenderSettings settings = make_settings();
  settings.lighting = make_lights();
  settings.lighting.lights.pop_back();
  const SeveralFields even = cube(11, linear_field, {second_field});
  const Camera camera = standard_cameras()[1].second;
  EXPECT_TRUE(tests::images_agree(even.draw(table, camera, settings),
                                  even.draw(function, camera, one_dimensional(settings)), 1e-5));
  // Normals that turn: both light a stretch where its emission lies, as far as they know that.
  settings.lighting.gradient_threshold = 0.0;
  const SeveralFields curved = cube(24, curved_field, {second_field});
  EXPECT_TRUE(tests::images_agree(curved.draw(table, camera, settings),
                                  curved.draw(function, camera, one_dimensional(settings)), 1e-3));
}

TEST_P(Multidimensional, ClippingSurfacesAndDepthAreThoseOfOneVariable) {
  const OpticalFunction function = make_bumpy_function(48);
  const OpticalTable table = make_table({kValue, kArray}, {48, 17}, [&](const std::array<double, 3>& p) {
    return eval_optical_function(function, p[0]);
  });
  RenderSettings settings = make_settings();
  settings.clipping.shapes = {{ClipSphere{{0.2, 0.1, 0.3}, 0.5}, false}};
  settings.surfaces.resize(1);
  settings.surfaces[0].value = 0.55;
  settings.surfaces[0].opacity = 0.4;
  settings.wants_depth = true;
  const SeveralFields body = cube(11, curved_field, {second_field});
  expect_same_pictures(body, table, function, settings, 1e-5);
  const Camera camera = standard_cameras()[0].second;
  const Image image = body.draw(table, camera, settings);
  const Image wanted = body.draw(function, camera, one_dimensional(settings));
  for (std::size_t i = 0; i < image.depth.size(); ++i)
    if (std::isfinite(wanted.depth[i])) {
      ASSERT_NEAR(image.depth[i], wanted.depth[i], 1e-4) << i;
    }
}

TEST_P(Multidimensional, ShadowsAreThoseOfOneVariable) {
  const OpticalFunction function = make_bumpy_function(48);
  const OpticalTable table = make_table({kValue, kArray}, {48, 17}, [&](const std::array<double, 3>& p) {
    return eval_optical_function(function, p[0]);
  });
  RenderSettings settings = make_settings();
  settings.lighting.lights = {{LightKind::kDirectional, {-1.0, 2.0, -1.5}, {}, {1, 1, 1}, 1.0}};
  settings.lighting.shadows = ShadowKind::kVolume;
  settings.lighting.shadow_resolution = 32;
  const SeveralFields body = cube(11, linear_field, {second_field});
  const Camera camera = standard_cameras()[0].second;
  EXPECT_TRUE(tests::images_agree(body.draw(table, camera, settings),
                                  body.draw(function, camera, one_dimensional(settings)), 1e-3));
}

// ---- several arrays ----

TEST_P(Multidimensional, TwoLinearFieldsHaveTheirIntegral) {
  const SeveralFields body = cube(9, linear_field, {second_field, third_field});
  for (const std::size_t size : {16u, 128u}) {
    const OpticalTable table = make_table({kValue, kArray}, {size, size + 3}, eval_smooth);
    expect_table_integral(body, table, {linear_field, second_field}, {2e-5, 1e-5});
  }
}

TEST_P(Multidimensional, ThreeLinearFieldsHaveTheirIntegral) {
  const SeveralFields body = cube(9, linear_field, {second_field, third_field});
  const OpticalTable table = make_table({kValue, kArray, kArray}, {32, 16, 64}, eval_smooth);
  expect_table_integral(body, table, {linear_field, second_field, third_field}, {2e-5, 1e-5});
}

TEST_P(Multidimensional, AFunctionNeedNotDependOnTheValue) {
  const SeveralFields body = cube(9, curved_field, {second_field, third_field});
  const OpticalTable table = make_table({kArray, kArray}, {40, 24}, eval_smooth);
  expect_table_integral(body, table, {second_field, third_field}, {2e-5, 1e-5});
}

TEST_P(Multidimensional, ThickAndThinMediaHaveTheirIntegral) {
  // Narrow widgets, nearly opaque, and nothing between them: most bricks of the grid are empty.
  MultidimensionalFunction function;
  function.variables = {kValue, kArray};
  function.widgets = {{WidgetShape::kGaussian, {0.4, 0.6, 0}, {0.05, 0.08, 1}, {1, 0.4, 0.1}, 0.9},
                      {WidgetShape::kTriangle, {0.6, 0.5, 0}, {0.2, 0.2, 1}, {0.1, 0.5, 1}, 0.6},
                      {WidgetShape::kRectangle, {0.75, 0.3, 0}, {0.03, 0.1, 1}, {0.2, 1, 0.3}, 0.99}};
  const std::array<ValueRange, 2> ranges{{{0, 1}, {0, 1}}};
  const OpticalTable table = make_optical_table(function, ranges, 0.1);
  const SeveralFields body = cube(is_grid() ? 40 : 9, linear_field, {second_field});
  expect_table_integral(body, table, {linear_field, second_field}, {5e-5, 5e-5});
}

TEST_P(Multidimensional, DefaultToleranceIsKept) {
  const SeveralFields body = cube(9, curved_field, {second_field, third_field});
  const OpticalTable table = make_table({kValue, kArray}, {64, 64}, eval_smooth);
  const Camera camera = standard_cameras()[0].second;
  EXPECT_TRUE(tests::images_agree(body.draw(table, camera, make_settings(2e-3)),
                                  body.draw(table, camera, make_settings()), 2e-3));
}

// ---- the gradient ----

TEST_P(Multidimensional, LinearFieldHasOneGradient) {
  const OpticalTable table = make_table({kValue, variable(VariableKind::kGradient, {0, 0.5})}, {64, 32}, eval_smooth);
  const SeveralFields body = cube(9, linear_field, {});
  expect_table_integral(body, table, {linear_field, [](const Vector3&) { return norm(kSlope); }}, {3e-5, 1e-5});
}

/// Depth of an extinction of `scale` * |p| along a part of a ray.
double integrate_distance(const Ray& ray, const Chord& chord, double scale) {
  const double nearest = -dot(ray.origin, ray.direction);
  const double square = dot(ray.origin, ray.origin) - nearest * nearest;
  const auto integral = [&](double t) {
    const double r = std::sqrt(square + t * t);
    return 0.5 * (t * r + square * std::log(t + r));
  };
  return scale * (integral(chord.far - nearest) - integral(chord.near - nearest));
}

TEST_P(Multidimensional, QuadraticFieldHasItsGradientInClosedForm) {
  // s = |p|^2 / 2 has the gradient p; what absorbs in proportion to that has a closed form. The border is left out,
  // where differences are one-sided.
  const Color color{0.9, 0.5, 0.2};
  const OpticalTable table =
      make_table({kValue, variable(VariableKind::kGradient, {0, 2})}, {16, 32}, [&](const std::array<double, 3>& p) {
        return OpticalPoint{0.0, 1.2 * p[1], color};
      });
  RenderSettings settings = make_settings(1e-6);
  const double half = 0.8;
  settings.clipping.shapes = {{ClipBox{{ValueRange{-half, half}, {-half, half}, {-half, half}}}, true}};
  const SeveralFields body = cube(20, [](const Vector3& p) { return 0.5 * dot(p, p); }, {});
  for (const auto& [name, camera] : standard_cameras())
    EXPECT_TRUE(shows(body.draw(table, camera, settings), camera,
                      [&](const Ray& ray) {
                        const Chord chord = intersect_box(ray, {-half, -half, -half}, {half, half, half});
                        return chord.length() > 0.0 ? fill(color, integrate_distance(ray, chord, 1.2)) : Rgba{};
                      },
                      {1e-4, 1e-4}))
        << name;
}

TEST_P(Multidimensional, DistanceHasTheGradientOne) {
  // A peak over the gradient, which misses most of what other gradients would show. No lattice finds the gradient near
  // the middle: left out there.
  const OpticalTable table =
      make_table({variable(VariableKind::kValue, {0, 2}), variable(VariableKind::kGradient, {0, 2})}, {65, 9},
                 [](const std::array<double, 3>& p) {
                   return OpticalPoint{0.0,
                                       std::max(0.0, 1.0 - std::abs(p[1] - 1.0)) * (1.0 + std::sin(4.0 * p[0])),
                                       {0.5 + 0.25 * p[0], 0.3, 1.0 - 0.5 * p[0]}};
                 });
  RenderSettings settings = make_settings(1e-5);
  settings.clipping.shapes = {{ClipSphere{{0, 0, 0}, 0.9}, true}, {ClipSphere{{0, 0, 0}, 0.4}, false}};
  const SeveralFields body = cube(is_grid() ? 64 : 40, norm, {});
  OpticalFunction function;
  for (std::size_t i = 0; i < 65; ++i) {
    function.points.push_back(table.entries[4 * 65 + i]);
    function.points.back().value = 2.0 * static_cast<double>(i) / 64.0;
  }
  expect_same_pictures(body, table, function, settings, 4e-3);
}

// ---- colour from another array ----

const OpticalFunction kOpacities{{{0.2, 0.0, {0, 0, 0}},
                                  {0.35, 2.0, {0, 0, 0}},
                                  {0.5, 0.3, {0, 0, 0}},
                                  {0.6, 0.3, {0, 0, 0}},
                                  {0.6, 1.4, {0, 0, 0}},
                                  {0.8, 0.9, {0, 0, 0}}}};
const OpticalFunction kColors{
    {{0.2, 0, {1, 0.1, 0}}, {0.45, 0, {0.2, 0.9, 0.3}}, {0.5, 0, {0.9, 0.9, 0.1}}, {0.9, 0, {0, 0.2, 1}}}};

TEST_P(Multidimensional, ColoursOfAnotherArrayHaveTheirIntegral) {
  const SeveralFields body = cube(9, linear_field, {second_field});
  expect_integral([&](const Camera& camera) { return body.draw(kOpacities, kColors, camera, make_settings()); },
                  [&](const Vector3& place) {
                    OpticalPoint point = eval_optical_function(kOpacities, linear_field(place));
                    point.color = eval_optical_function(kColors, second_field(place)).color;
                    return point;
                  },
                  {5e-4, 5e-4});  // of the numeric integral at the step
}

TEST_P(Multidimensional, ColoursOfAnotherArrayLeaveOpacityExact) {
  OpticalFunction spikes;
  for (int i = 0; i <= 400; ++i) spikes.points.push_back({0.0025 * i, i % 10 == 5 ? 20.0 : 0.0, {1.0, 0.5, 0.25}});
  for (const tests::Field& field : {tests::Field(linear_field), tests::Field(curved_field)}) {
    const SeveralFields body = cube(9, field, {second_field});
    for (const auto& [name, camera] : standard_cameras()) {
      const Image image = body.draw(spikes, kColors, camera, make_settings());
      const Image wanted = body.draw(spikes, camera, one_dimensional(make_settings()));
      for (std::size_t i = 3; i < image.pixels.size(); i += 4)
        ASSERT_NEAR(image.pixels[i], wanted.pixels[i], 2e-5) << name << ", value " << i;
    }
  }
}

TEST_P(Multidimensional, OneColourOfAnotherArrayIsThePictureOfOneArray) {
  OpticalFunction white = make_bumpy_function(48);
  for (OpticalPoint& point : white.points) point.color = {0.9, 0.6, 0.3};
  const OpticalFunction colors{{{0.0, 0.0, {0.9, 0.6, 0.3}}}};
  const SeveralFields body = cube(9, curved_field, {second_field});
  RenderSettings settings = make_settings();
  for (const bool is_lit : {false, true}) {
    if (is_lit) settings.lighting = make_lights();
    const Camera camera = standard_cameras()[0].second;
    EXPECT_TRUE(tests::images_agree(body.draw(white, colors, camera, settings),
                                    body.draw(white, camera, one_dimensional(settings)), is_lit ? 2e-3 : 1e-5));
  }
}

TEST_P(Multidimensional, ATransferFunctionSetAnewDrawsAlone) {
  const SeveralFields body = cube(5, linear_field, {second_field});
  const Camera camera = standard_cameras()[0].second;
  const Image wanted = body.draw(kOpacities, camera, make_settings());
  Renderer renderer = body.make_renderer();
  renderer.set_multidimensional_function(make_table({kValue, kArray}, {16, 16}, eval_smooth));
  RenderStatistics statistics;
  renderer.render(camera, make_settings(), &statistics);
  EXPECT_EQ(statistics.integrator, "domain");
  renderer.set_transfer_function(kOpacities);
  EXPECT_TRUE(tests::images_equal(renderer.render(camera, make_settings(), &statistics), wanted));
  EXPECT_EQ(statistics.integrator, "antiderivative");
  renderer.set_color_function(0, kColors);
  EXPECT_FALSE(tests::images_agree(renderer.render(camera, make_settings()), wanted, 1e-2));
  renderer.set_transfer_function(kOpacities);
  EXPECT_TRUE(tests::images_equal(renderer.render(camera, make_settings()), wanted));
}

// ---- cell data, filters, missing values ----

/// A value for each of the cells of a cube with `cells` a side.
double number_of_cell(const Vector3& p, int cells) {
  double number = 0.0;
  for (int axis = 2; axis >= 0; --axis) number = number * cells + std::floor(0.5 * (p[axis] + 1.0) * cells);
  return number / (cells * cells * cells);
}

TEST_P(Multidimensional, CellDataAreConstantInTheirCells) {
  constexpr int kCells = 4;
  const auto other = [](double value) { return std::abs(std::sin(40.0 * value)); };
  const SeveralFields body(
      is_grid(), kCells, [](const Vector3& p) { return number_of_cell(p, kCells); }, other);
  const OpticalTable table = make_table({kValue, kArray}, {50, 70}, eval_smooth);
  OpticalFunction wanted, opacities, wanted_colors;
  for (int i = 0; i < kCells * kCells * kCells; ++i) {
    const double value = static_cast<double>(i) / (kCells * kCells * kCells);
    OpticalPoint point = eval_optical_table(table, std::array{value, other(value)});
    point.value = value;
    wanted.points.push_back(point);
    opacities.points.push_back(point);
    wanted_colors.points.push_back(point);
    wanted_colors.points.back().color = eval_optical_function(kColors, other(value)).color;
  }
  for (const auto& [name, camera] : standard_cameras()) {
    EXPECT_TRUE(tests::images_agree(body.draw(table, camera, make_settings()),
                                    body.draw(wanted, camera, make_settings()), 1e-5))
        << name;
    EXPECT_TRUE(tests::images_agree(body.draw(opacities, kColors, camera, make_settings()),
                                    body.draw(wanted_colors, camera, make_settings()), 1e-5))
        << name;
  }
}

TEST(MultidimensionalGrids, FiltersReconstructAllFields) {
  const OpticalFunction function = make_bumpy_function(24);
  const SeveralFields body(true, 9, curved_field, std::vector<tests::Field>{second_field});
  RenderSettings settings = make_careful_settings(Integrator::kAntiderivative);
  settings.tolerance = 1e-6;
  RenderSettings single = settings;
  single.integrator = Integrator::kPartial;
  const Camera camera = standard_cameras()[0].second;
  for (const FilterKind kind : {FilterKind::kNearest, FilterKind::kBspline, FilterKind::kInterpolatingBspline}) {
    settings.filter.kind = single.filter.kind = kind;
    const OpticalTable by_value = make_table({kValue, kArray}, {24, 17}, [&](const std::array<double, 3>& p) {
      return eval_optical_function(function, p[0]);
    });
    EXPECT_TRUE(tests::images_agree(body.draw(by_value, camera, settings), body.draw(function, camera, single),
                                    kind == FilterKind::kNearest ? 1e-5 : 1e-3))
        << name_of(settings.filter);
    // And by the other field, as if that were the value.
    const OpticalTable by_other = make_table({kArray, kValue}, {24, 17}, [&](const std::array<double, 3>& p) {
      return eval_optical_function(function, p[0]);
    });
    const SeveralFields turned(true, 9, second_field, std::vector<tests::Field>{});
    EXPECT_TRUE(tests::images_agree(body.draw(by_other, camera, settings), turned.draw(function, camera, single),
                                    kind == FilterKind::kNearest ? 1e-5 : 1e-3))
        << name_of(settings.filter);
  }
}

TEST_P(Multidimensional, MissingValuesOfAnyFieldAreTransparent) {
  const auto half = [](const Vector3& p) {
    return p[0] > 0.3 ? std::numeric_limits<double>::quiet_NaN() : second_field(p);
  };
  const OpticalTable table = make_table({kValue, kArray}, {24, 24}, eval_smooth);
  const SeveralFields missing = cube(10, linear_field, {half});
  const SeveralFields whole = cube(10, linear_field, {second_field});
  RenderSettings settings = make_settings();
  const Camera camera = standard_cameras()[1].second;
  const Image image = missing.draw(table, camera, settings);
  settings.clipping.shapes = {
      {ClipBox{{ValueRange{-2, 0.2}, {-2, 2}, {-2, 2}}}, true}};  // cells with a corner beyond are left out
  EXPECT_TRUE(tests::images_agree(image, whole.draw(table, camera, settings), 1e-5));
}

// ---- what holds for every picture ----

TEST_P(Multidimensional, ThreadsDoNotChangeAByte) {
  const SeveralFields body = cube(9, curved_field, {second_field});
  const OpticalTable table =
      make_table({kValue, kArray, variable(VariableKind::kGradient, {0, 1})}, {24, 20, 16}, eval_smooth);
  RenderSettings settings = make_settings(2e-3);
  settings.lighting = make_lights();
  const Camera camera = standard_cameras()[0].second;
  settings.threads = 1;
  const Image one = body.draw(table, camera, settings);
  settings.threads = 3;
  EXPECT_TRUE(tests::images_equal(body.draw(table, camera, settings), one));
  for (const std::string& set : instruction_sets()) {
    settings.instruction_set = set;
    EXPECT_TRUE(tests::images_equal(body.draw(table, camera, settings), one)) << set;
  }
}

TEST_P(Multidimensional, WhatDoesNotGoTogetherIsSaid) {
  const SeveralFields body = cube(3, linear_field, {second_field});
  Renderer renderer = body.make_renderer();
  const auto code_of = [](const auto& action) {
    try {
      action();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return error.code();
    }
    return ErrorCode::kInternal;
  };
  const OpticalTable table = make_table({kValue, kArray}, {16, 16}, eval_smooth);
  EXPECT_EQ(code_of([&] { renderer.set_color_function(0, kColors); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([&] { renderer.set_multidimensional_function(table, {1}); }), ErrorCode::kInvalidArgument);
  renderer.set_multidimensional_function(table, {0});
  EXPECT_EQ(code_of([&] { renderer.set_color_function(0, kColors); }), ErrorCode::kInvalidArgument);
  OpticalTable damaged = table;
  damaged.entries.pop_back();
  EXPECT_EQ(code_of([&] { renderer.set_multidimensional_function(damaged); }), ErrorCode::kInvalidArgument);
  for (const Integrator integrator : {Integrator::kPost, Integrator::kPre}) {
    RenderSettings settings = make_settings();
    settings.integrator = integrator;
    EXPECT_EQ(code_of([&] { renderer.render(standard_cameras()[0].second, settings); }), ErrorCode::kUnsupported);
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, Multidimensional, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "grid" : "mesh"; });

}  // namespace
}  // namespace tetravox::analytic
