/// What only grids have: quadratic fields along rays, directions, uneven axes, number types, filters, odd shapes.

#include "tests/analytic/show.h"
#include "tests/common/grid_builder.h"
#include "tests/common/image_compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace tetravox::analytic {
namespace {

using tests::Body;
using tests::GridOptions;
using tests::make_grid;

const Vector3 kLower{-1.0, -0.8, -0.9};
const Vector3 kUpper{1.1, 0.9, 0.7};
const Color kColor{0.9, 0.6, 0.3};

GridOptions box_options(const std::array<std::uint32_t, 3>& dimensions) {
  GridOptions options;
  options.dimensions = dimensions;
  options.lower = kLower;
  options.upper = kUpper;
  return options;
}

/// s(t) = a + b t + c t^2 along a ray.
struct Quadratic {
  double a = 0.0, b = 0.0, c = 0.0;

  double at(double t) const { return a + t * (b + t * c); }
  double integral(double from, double to) const {
    const auto primitive = [&](double t) { return t * (a + t * (b / 2.0 + t * c / 3.0)); };
    return primitive(to) - primitive(from);
  }
  /// Where it has this value, ascending.
  std::vector<double> places(double value) const {
    const double discriminant = b * b - 4.0 * c * (a - value);
    if (discriminant < 0.0) return {};
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    std::vector<double> roots{q / c, (a - value) / q};
    std::sort(roots.begin(), roots.end());
    return roots;
  }
};

/// Through any three of its values.
Quadratic fit_quadratic(const std::function<double(double)>& value) {
  const double first = value(0.0), middle = value(1.0), last = value(2.0);
  Quadratic q{first, 0.0, 0.5 * (first - 2.0 * middle + last)};
  q.b = middle - first - q.c;
  return q;
}

/// A cubic with an inflection in the middle of its only cell: it leaves its chord on both sides.
double bent_both_ways(const Vector3& p) { return 0.5 + 0.5 * p[0] * p[1] * p[2]; }

class Grids : public ::testing::TestWithParam<Integrator> {
 protected:
  static void expect_shown(const Body& body, const OpticalFunction& function,
                           const std::function<Rgba(const Ray&)>& expected, const Tolerance& tolerance,
                           const Filter& filter = {}) {
    RenderSettings settings = make_careful_settings(GetParam());
    settings.filter = filter;
    analytic::expect_shown(body, function, settings, expected, tolerance);
  }
  /// Fields that bend along a ray are drawn as well as the tolerance asks: twice the error that the default stands for
  /// in the worst pixel, ten times a fine one.
  static void expect_bent(const Body& body, const OpticalFunction& function,
                          const std::function<Rgba(const Ray&)>& expected) {
    RenderSettings settings = make_careful_settings(GetParam());
    analytic::expect_shown(body, function, settings, expected, {4e-3, 4e-3});
    settings.tolerance = 1e-4;
    analytic::expect_shown(body, function, settings, expected, {1e-3, 1e-3});
  }
  /// A homogeneous medium that fills what `chord_of` says.
  static void expect_chords(const Body& body, const std::function<Chord(const Ray&)>& chord_of,
                            const Filter& filter = {}) {
    const OpticalFunction function{{{0.0, 0.8, kColor}}};
    expect_shown(
        body, function, [&](const Ray& ray) { return fill(kColor, 0.8 * chord_of(ray).length()); },
        constant_tolerance(GetParam()), filter);
  }
};

double product_field(const Vector3& p) { return 0.5 + 0.4 * p[0] * p[1]; }

TEST_P(Grids, QuadraticFieldWithALinearFunctionHasItsIntegral) {
  // Trilinear interpolation reproduces x y exactly; along a ray it is quadratic, and so is the extinction.
  const OpticalFunction function{{{0.0, 0.0, kColor}, {1.0, 3.0, kColor}}};
  expect_bent(make_grid(box_options({7, 6, 5}), product_field), function, [](const Ray& ray) {
    const Chord chord = intersect_box(ray, kLower, kUpper);
    if (chord.length() == 0.0) return Rgba{};
    const Quadratic scalar = fit_quadratic([&](double t) { return product_field(ray.at(t)); });
    return fill(kColor, 3.0 * scalar.integral(chord.near, chord.far));
  });
}

TEST_P(Grids, QuadraticFieldMeetsStepsTwice) {
  if (GetParam() == Integrator::kPre) GTEST_SKIP() << "colours between the values are interpolated, not classified";
  const OpticalFunction function{{{0.42, 0.0, kColor}, {0.42, 1.2, kColor}, {0.55, 1.2, kColor}, {0.55, 0.0, kColor}}};
  expect_shown(make_grid(box_options({17, 18, 5}), product_field), function,
               [](const Ray& ray) {
                 const Chord chord = intersect_box(ray, kLower, kUpper);
                 if (chord.length() == 0.0) return Rgba{};
                 const Quadratic scalar = fit_quadratic([&](double t) { return product_field(ray.at(t)); });
                 std::vector<double> cuts{chord.near, chord.far};
                 for (const double value : {0.42, 0.55})
                   for (const double t : scalar.places(value))
                     if (t > chord.near && t < chord.far) cuts.push_back(t);
                 std::sort(cuts.begin(), cuts.end());
                 double length = 0.0;
                 for (std::size_t i = 1; i < cuts.size(); ++i) {
                   const double value = scalar.at(0.5 * (cuts[i - 1] + cuts[i]));
                   if (value > 0.42 && value < 0.55) length += cuts[i] - cuts[i - 1];
                 }
                 return fill(kColor, 1.2 * length);
               },
               {4e-3, 4e-3});
}

TEST_P(Grids, CubicFieldWithALinearFunctionHasItsIntegral) {
  const auto field = [](const Vector3& p) { return 0.5 + 0.4 * p[0] * p[1] * p[2]; };
  const OpticalFunction function{{{0.0, 0.0, kColor}, {1.0, 3.0, kColor}}};
  expect_bent(make_grid(box_options({4, 5, 6}), field), function, [&](const Ray& ray) {
    const Chord chord = intersect_box(ray, kLower, kUpper);
    if (chord.length() == 0.0) return Rgba{};
    // Simpson's rule is exact for cubics.
    const double sum =
        field(ray.at(chord.near)) + field(ray.at(chord.far)) + 4.0 * field(ray.at(0.5 * (chord.near + chord.far)));
    return fill(kColor, 3.0 * chord.length() * sum / 6.0);
  });
}

TEST_P(Grids, ACurveMayLeaveItsChordOnBothSides) {
  // Along x = y = z through one cell the scalar is 1/2 + x^3 / 2, symmetric about the middle; within 1/16 of 1/2 for
  // |x| < 1/2: half of the way, where its chord is for an eighth.
  if (GetParam() == Integrator::kPre) GTEST_SKIP() << "colours between the values are interpolated, not classified";
  const OpticalFunction function{
      {{0.4375, 0.0, kColor}, {0.4375, 0.5, kColor}, {0.5625, 0.5, kColor}, {0.5625, 0.0, kColor}}};
  GridOptions options;
  options.dimensions = {2, 2, 2};
  Camera camera;
  camera.position = {3, 3, 3};
  camera.view_up = {0, 0, 1};
  camera.parallel_scale = 1e-3;
  RenderSettings settings = make_careful_settings(GetParam());
  const Body body = make_grid(options, bent_both_ways);
  for (const double tolerance : {2e-3, 1e-4}) {
    settings.tolerance = tolerance;
    EXPECT_TRUE(shows(body.draw(function, camera, settings), camera,
                      [](const Ray&) { return fill(kColor, 0.5 * std::sqrt(3.0)); },
                      {tolerance > 1e-3 ? 4e-3 : 1e-3, tolerance > 1e-3 ? 4e-3 : 1e-3}))
        << tolerance;
  }
}

/// Chord through the box [lower, upper] whose points are moved by `direction` about its middle.
Chord intersect_turned_box(const Ray& ray, const GridShape& shape, const Vector3& extent) {
  const auto& m = shape.direction;
  const double volume =
      m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
  const auto to_lattice = [&](const Vector3& v) {
    return Vector3{
        ((m[4] * m[8] - m[5] * m[7]) * v[0] + (m[2] * m[7] - m[1] * m[8]) * v[1] + (m[1] * m[5] - m[2] * m[4]) * v[2]) /
            volume,
        ((m[5] * m[6] - m[3] * m[8]) * v[0] + (m[0] * m[8] - m[2] * m[6]) * v[1] + (m[2] * m[3] - m[0] * m[5]) * v[2]) /
            volume,
        ((m[3] * m[7] - m[4] * m[6]) * v[0] + (m[1] * m[6] - m[0] * m[7]) * v[1] + (m[0] * m[4] - m[1] * m[3]) * v[2]) /
            volume};
  };
  Vector3 from_origin = ray.origin;
  for (int k = 0; k < 3; ++k) from_origin[k] -= shape.origin[k];
  return intersect_box({to_lattice(from_origin), to_lattice(ray.direction)}, {0, 0, 0}, extent);
}

const std::pair<const char*, std::array<double, 9>> kDirections[] = {
    {"turned", {0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6}},
    {"exchanged", {0, 1, 0, 0, 0, 1, 1, 0, 0}},
    {"mirrored", {-1, 0, 0, 0, 1, 0, 0, 0, 1}},
    {"medical", {0.0, -0.99, 0.1, 0.02, 0.1, 0.99, -1.0, 0.0, 0.02}},
    {"sheared", {1.0, 0.4, -0.3, 0.0, 1.0, 0.2, 0.0, 0.0, 1.0}},
    {"sheared, mirrored and scaled", {0.3, 0.9, 0.1, 0.8, 0.2, -0.3, 0.1, 0.2, 0.9}}};

TEST_P(Grids, DirectionTurnsTheBox) {
  for (const auto& [name, direction] : kDirections) {
    SCOPED_TRACE(name);
    GridOptions options;
    options.dimensions = {9, 4, 6};
    options.direction = direction;
    const GridData grid = make_grid(options, [](const Vector3&) { return 1.0; });
    expect_chords(grid, [&](const Ray& ray) { return intersect_turned_box(ray, grid.shape, {2, 2, 2}); });
  }
}

TEST_P(Grids, DirectionTurnsTheField) {
  const OpticalFunction function{{{0.0, 0.0, kColor}, {1.0, 3.0, kColor}}};
  const auto field = [](const Vector3& p) { return 0.5 + 0.11 * p[0] - 0.08 * p[1] + 0.06 * p[2]; };
  for (const auto& [name, direction] : kDirections) {
    SCOPED_TRACE(name);
    GridOptions options;
    options.dimensions = {9, 4, 6};
    options.direction = direction;
    const GridData grid = make_grid(options, field);
    expect_shown(
        grid, function,
        [&](const Ray& ray) {
          const Chord chord = intersect_turned_box(ray, grid.shape, {2, 2, 2});
          if (chord.length() == 0.0) return Rgba{};
          const double mean = 0.5 * (field(ray.at(chord.near)) + field(ray.at(chord.far)));
          return fill(kColor, 3.0 * mean * chord.length());
        },
        varying_tolerance(GetParam(), 2e-4));
  }
}

TEST_P(Grids, MayHaveAnyShape) {
  for (const std::array<std::uint32_t, 3>& dimensions : {std::array<std::uint32_t, 3>{2, 2, 2},
                                                         {2, 2, 1000},
                                                         {1000, 2, 2},
                                                         {2, 900, 3},
                                                         {9, 9, 9},
                                                         {10, 17, 8},
                                                         {8, 16, 25},
                                                         {3, 2, 65},
                                                         {33, 34, 2}}) {
    SCOPED_TRACE(::testing::PrintToString(dimensions));
    expect_chords(make_grid(box_options(dimensions), [](const Vector3&) { return 1.0; }),
                  [](const Ray& ray) { return intersect_box(ray, kLower, kUpper); });
  }
}

TEST_P(Grids, LinearFieldInAnyShape) {
  const OpticalFunction function{{{0.0, 0.0, kColor}, {1.0, 3.0, kColor}}};
  const auto field = [](const Vector3& p) { return 0.5 + 0.21 * p[0] - 0.13 * p[1] + 0.16 * p[2]; };
  for (const std::array<std::uint32_t, 3>& dimensions :
       {std::array<std::uint32_t, 3>{2, 2, 2}, {2, 2, 1000}, {10, 17, 8}}) {
    SCOPED_TRACE(::testing::PrintToString(dimensions));
    RenderSettings settings = make_careful_settings(GetParam());
    if (dimensions[2] > 100) settings.samples = 16;  // hundreds of thousands of samples a ray would add up rounding
    analytic::expect_shown(
        make_grid(box_options(dimensions), field), function, settings,
        [&](const Ray& ray) {
          const Chord chord = intersect_box(ray, kLower, kUpper);
          if (chord.length() == 0.0) return Rgba{};
          const double mean = 0.5 * (field(ray.at(chord.near)) + field(ray.at(chord.far)));
          return fill(kColor, 3.0 * mean * chord.length());
        },
        varying_tolerance(GetParam(), 2e-4));
  }
}

TEST_P(Grids, ThinnerThanAnyVoxelIsLong) {
  // A needle a thousand cells long; seen from its side and along it.
  GridOptions options;
  options.dimensions = {2, 2, 1000};
  options.lower = {-0.02, -0.02, -1.0};
  options.upper = {0.02, 0.02, 1.0};
  const Body body = make_grid(options, [](const Vector3&) { return 1.0; });
  const OpticalFunction function{{{0.0, 0.8, kColor}}};
  Camera side, along;
  side.position = {0.3, -2.0, 0.1};
  side.focal_point = {0.0, 0.0, 0.1};
  side.view_up = {1, 0, 0};
  side.parallel_scale = 0.03;
  along.position = {0.001, -0.002, 4.0};
  along.view_angle = 0.6;
  for (const Camera& camera : {side, along})
    EXPECT_TRUE(shows(
        body.draw(function, camera, make_careful_settings(GetParam())), camera,
        [&](const Ray& ray) { return fill(kColor, 0.8 * intersect_box(ray, options.lower, options.upper).length()); },
        {2e-5, 2e-5}));
}

TEST_P(Grids, UnevenAxesHoldALinearField) {
  const OpticalFunction function{{{0.0, 0.0, kColor}, {1.0, 3.0, kColor}}};
  const auto field = [](const Vector3& p) { return 0.5 + 0.21 * p[0] - 0.13 * p[1] + 0.16 * p[2]; };
  GridOptions options = box_options({9, 21, 10});
  options.fractions[0] = tests::growing_fractions(9, 5.0);
  options.fractions[1] = tests::growing_fractions(21, 0.1);
  for (const double growth : {0.0, 100.0}) {  // the last axis even, then uneven
    if (growth > 0.0) options.fractions[2] = tests::growing_fractions(10, growth);
    expect_shown(
        make_grid(options, field), function,
        [&](const Ray& ray) {
          const Chord chord = intersect_box(ray, kLower, kUpper);
          if (chord.length() == 0.0) return Rgba{};
          const double mean = 0.5 * (field(ray.at(chord.near)) + field(ray.at(chord.far)));
          return fill(kColor, 3.0 * mean * chord.length());
        },
        varying_tolerance(GetParam(), 2e-4));
  }
}

TEST_P(Grids, UnevenCellDataHaveTheirBorders) {
  // Four layers along y of different thickness.
  const double borders[5] = {0.0, 0.05, 0.4, 0.5, 1.0};
  const double extinctions[4] = {9.0, 0.3, 4.0, 0.8};
  OpticalFunction function;
  for (int i = 0; i < 4; ++i) function.points.push_back({static_cast<double>(i), extinctions[i], kColor});
  GridOptions options = box_options({3, 5, 4});
  options.association = Association::kCell;
  options.fractions[1].assign(borders, borders + 5);
  const auto y_at = [&](int i) { return kLower[1] + borders[i] * (kUpper[1] - kLower[1]); };
  const Body body = make_grid(options, [&](const Vector3& p) {
    int layer = 0;
    while (layer < 3 && p[1] > y_at(layer + 1)) ++layer;
    return static_cast<double>(layer);
  });
  expect_shown(
      body, function,
      [&](const Ray& ray) {
        double depth = 0.0;
        for (int i = 0; i < 4; ++i)
          depth += extinctions[i] *
                   intersect_box(ray, {kLower[0], y_at(i), kLower[2]}, {kUpper[0], y_at(i + 1), kUpper[2]}).length();
        return fill(kColor, depth);
      },
      constant_tolerance(GetParam()));
}

TEST_P(Grids, NearestChangesHalfwayBetweenPoints) {
  // Points at x = -1, 0, 1: borders at -1/2 and 1/2.
  const double extinctions[3] = {2.0, 0.1, 0.9};
  OpticalFunction function;
  for (int i = 0; i < 3; ++i) function.points.push_back({i - 1.0, extinctions[i], kColor});
  GridOptions options;
  options.dimensions = {3, 4, 2};
  expect_shown(make_grid(options, [](const Vector3& p) { return p[0]; }), function,
               [&](const Ray& ray) {
                 double depth = 0.0;
                 const double borders[4] = {-1.0, -0.5, 0.5, 1.0};
                 for (int i = 0; i < 3; ++i)
                   depth += extinctions[i] * intersect_box(ray, {borders[i], -1, -1}, {borders[i + 1], 1, 1}).length();
                 return fill(kColor, depth);
               },
               constant_tolerance(GetParam()), {FilterKind::kNearest});
}

TEST_P(Grids, AConstantIsConstantWithEveryFilter) {
  for (const Association association : {Association::kPoint, Association::kCell}) {
    GridOptions options = box_options({11, 6, 9});
    options.association = association;
    const GridData grid = make_grid(options, [](const Vector3&) { return 17.25; });
    for (const Filter& filter :
         {Filter{FilterKind::kNearest}, Filter{FilterKind::kBspline}, Filter{FilterKind::kInterpolatingBspline},
          Filter{FilterKind::kCatmullRom}, Filter{FilterKind::kMitchell}, Filter{FilterKind::kLanczos, 2},
          Filter{FilterKind::kLanczos, 8}}) {
      SCOPED_TRACE(name_of(filter));
      if (GetParam() == Integrator::kPre && filter.kind == FilterKind::kInterpolatingBspline) continue;  // refused
      // Cell data are points at the middles of their cells to kernels.
      Vector3 lower = kLower, upper = kUpper;
      const double cells[3] = {10, 5, 8};
      for (int axis = 0; axis < 3 && association == Association::kCell && filter.kind != FilterKind::kNearest; ++axis) {
        const double half = 0.5 * (kUpper[axis] - kLower[axis]) / cells[axis];
        lower[axis] += half;
        upper[axis] -= half;
      }
      expect_chords(
          grid, [&](const Ray& ray) { return intersect_box(ray, lower, upper); }, filter);
    }
  }
}

TEST_P(Grids, MissingValuesTakeTheirCellsAndNothingElse) {
  // The point in the middle is a corner of eight cells, the point at the grid's corner of one.
  const auto field = [](const Vector3& p) {
    const bool is_middle = std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) < 1e-9;
    const bool is_corner = p[0] + p[1] + p[2] > 3.0 - 1e-9;
    if (is_middle) return std::numeric_limits<double>::quiet_NaN();
    return is_corner ? std::numeric_limits<double>::infinity() : 1.0;
  };
  GridOptions options;
  options.dimensions = {5, 5, 5};
  const OpticalFunction function{{{0.0, 0.8, kColor}}};
  expect_shown(
      make_grid(options, field), function,
      [](const Ray& ray) {
        return fill(kColor, 0.8 * (intersect_box(ray, {-1, -1, -1}, {1, 1, 1}).length() -
                                   intersect_box(ray, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}).length() -
                                   intersect_box(ray, {0.5, 0.5, 0.5}, {1, 1, 1}).length()));
      },
      constant_tolerance(GetParam()));
}

TEST_P(Grids, MissingCellsAreEmpty) {
  GridOptions options;
  options.dimensions = {5, 5, 5};
  options.association = Association::kCell;
  const auto field = [](const Vector3& p) {
    return p[0] > 0.5 && p[1] > 0.5 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  };
  const OpticalFunction function{{{0.0, 0.8, kColor}}};
  expect_shown(
      make_grid(options, field), function,
      [](const Ray& ray) {
        return fill(kColor, 0.8 * (intersect_box(ray, {-1, -1, -1}, {1, 1, 1}).length() -
                                   intersect_box(ray, {0.5, 0.5, -1}, {1, 1, 1}).length()));
      },
      constant_tolerance(GetParam()));
}

TEST_P(Grids, EveryNumberTypeGivesTheSamePicture) {
  const auto field = [](const Vector3& p) { return std::nearbyint(60.0 + 40.0 * std::sin(3.0 * p[0] + p[1] * p[2])); };
  const OpticalFunction function{
      {{20.0, 0.0, {0, 0, 1}}, {50.0, 1.5, {0, 1, 0}}, {70.0, 0.1, {1, 1, 0}}, {100.0, 2.5, {1, 0, 0}}}};
  GridOptions options;
  options.dimensions = {14, 11, 12};
  const RenderSettings settings = tests::make_settings(GetParam(), 61, 43);
  const Camera camera = standard_cameras()[0].second;
  options.type = ScalarType::kFloat64;
  const Image expected = Body(make_grid(options, field)).draw(function, camera, settings);
  EXPECT_GT(tests::count_covered(expected), 500u);
  for (const ScalarType type : tests::kAllScalarTypes) {
    options.type = type;
    EXPECT_TRUE(tests::images_equal(Body(make_grid(options, field)).draw(function, camera, settings), expected))
        << scalar_type_name(type);
    const auto other = [](const Vector3& p) { return 3.0 + p[0]; };
    for (const int component : {0, 1, 2}) {
      std::vector<tests::Field> fields(3, other);
      fields[component] = field;
      const Body body = tests::make_vector_grid(options, fields, component);
      EXPECT_TRUE(tests::images_equal(body.draw(function, camera, settings), expected))
          << scalar_type_name(type) << ", component " << component;
    }
  }
}

TEST_P(Grids, MagnitudeIsTheLengthOfAllComponents) {
  const auto field = [](const Vector3& p) { return 5.0 + 2.0 * std::sin(3.0 * p[0] + p[1] * p[2]); };
  const OpticalFunction function{{{0.0, 0.0, {0, 0, 1}}, {50.0, 1.5, {0, 1, 0}}, {100.0, 2.5, {1, 0, 0}}}};
  GridOptions options;
  options.dimensions = {14, 11, 12};
  options.type = ScalarType::kFloat64;
  std::vector<tests::Field> fields;
  for (const double factor : {-3.0, 4.0, 12.0})
    fields.push_back([&, factor](const Vector3& p) { return factor * field(p); });
  const Body scalars = make_grid(options, [&](const Vector3& p) { return 13.0 * field(p); });
  const Body vectors = tests::make_vector_grid(options, fields, kMagnitude);
  const RenderSettings settings = tests::make_settings(GetParam(), 61, 43);
  for (const auto& [name, camera] : standard_cameras())
    EXPECT_TRUE(
        tests::images_agree(vectors.draw(function, camera, settings), scalars.draw(function, camera, settings), 1e-5))
        << name;
}

INSTANTIATE_TEST_SUITE_P(All, Grids, ::testing::ValuesIn(tests::kGridIntegrators),
                         [](const auto& test) { return name_of(test.param); });

TEST(PreClassification, ColoursAreInterpolatedBetweenTheValues) {
  // Values 0 and 1 in turn: the function between them is never seen; extinction and colour go from end to end.
  const OpticalFunction function{
      {{0.0, 0.4, {1, 0, 0}}, {0.3, 90.0, {0, 0, 1}}, {0.7, 90.0, {0, 0, 1}}, {1.0, 1.6, {0, 1, 0}}}};
  GridOptions options;
  options.dimensions = {2, 3, 3};
  const Body body = make_grid(options, [](const Vector3& p) { return 0.5 + 0.5 * p[0]; });
  expect_shown(body, function, make_careful_settings(Integrator::kPre),
               [&](const Ray& ray) {
                 const Chord chord = intersect_box(ray, {-1, -1, -1}, {1, 1, 1});
                 if (chord.length() == 0.0) return Rgba{};
                 return integrate(chord.length(), [&](double u) {
                   const double x = 0.5 + 0.5 * ray.at(chord.near + u * chord.length())[0];
                   const double red = 0.4 * (1.0 - x), green = 1.6 * x, extinction = red + green;
                   return Medium{extinction, {red / extinction, green / extinction, 0.0}};
                 });
               },
               {2e-3, 2e-4});
}

}  // namespace
}  // namespace tetravox::analytic
