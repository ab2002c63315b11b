/// The reference for grids held against closed forms, fine sums and the reference for meshes.

#include "tests/common/cameras.h"
#include "tests/common/functions.h"
#include "tests/common/grid_builder.h"
#include "tests/common/image_compare.h"
#include "tests/reference/curve.h"
#include "tests/reference/grid_field.h"
#include "tests/reference/grid_integrator.h"
#include "tests/reference/integrator.h"
#include "tests/reference/kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace tetravox::reference {
namespace {

using tests::GridOptions;
using tests::images_agree;
using tests::make_grid;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const Filter kAllFilters[] = {
    {FilterKind::kLinear},     {FilterKind::kNearest},  {FilterKind::kBspline},    {FilterKind::kInterpolatingBspline},
    {FilterKind::kCatmullRom}, {FilterKind::kMitchell}, {FilterKind::kLanczos, 2}, {FilterKind::kLanczos, 3},
    {FilterKind::kLanczos, 8}};

/// Sum of weight * (index - fraction)^power: the kernel's moment.
double moment(const Filter& filter, double fraction, int power) {
  double weights[16];
  const int radius = kernel_radius(filter);
  make_weights(filter, fraction, weights);
  double sum = 0.0;
  for (int j = 0; j < 2 * radius; ++j) sum += weights[j] * std::pow(j - radius + 1 - fraction, power);
  return sum;
}

TEST(Kernels, HaveTheMomentsOfTheirPapers) {
  for (const double fraction : {0.0, 0.1, 0.37, 0.5, 0.81, 1.0}) {
    for (const Filter& filter : kAllFilters) {
      if (filter.kind == FilterKind::kNearest) continue;
      EXPECT_NEAR(moment(filter, fraction, 0), 1.0, 1e-14);
    }
    for (const FilterKind kind :
         {FilterKind::kLinear, FilterKind::kBspline, FilterKind::kCatmullRom, FilterKind::kMitchell})
      EXPECT_NEAR(moment({kind}, fraction, 1), 0.0, 1e-14);
    EXPECT_NEAR(moment({FilterKind::kCatmullRom}, fraction, 2), 0.0, 1e-14);
    EXPECT_NEAR(moment({FilterKind::kBspline}, fraction, 2), 1.0 / 3.0, 1e-14);
    EXPECT_NEAR(moment({FilterKind::kBspline}, fraction, 3), 0.0, 1e-14);
  }
}

TEST(Kernels, HaveTheValuesOfTheirPapers) {
  double weights[16];
  make_weights({FilterKind::kBspline}, 0.0, weights);
  EXPECT_NEAR(weights[0], 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(weights[1], 4.0 / 6.0, 1e-15);
  make_weights({FilterKind::kMitchell}, 0.0, weights);
  EXPECT_NEAR(weights[0], 1.0 / 18.0, 1e-15);
  EXPECT_NEAR(weights[1], 16.0 / 18.0, 1e-15);
  make_weights({FilterKind::kMitchell}, 0.5, weights);
  EXPECT_NEAR(weights[0], -5.0 / 144.0, 1e-15);
  make_weights({FilterKind::kCatmullRom}, 0.5, weights);
  EXPECT_NEAR(weights[0], -1.0 / 16.0, 1e-15);
  EXPECT_NEAR(weights[1], 9.0 / 16.0, 1e-15);
  make_weights({FilterKind::kLanczos, 3}, 0.0, weights);
  EXPECT_NEAR(weights[2], 1.0, 1e-15);
  EXPECT_NEAR(weights[3], 0.0, 1e-15);
  // Before the weights are divided by their sum: L(1/2) = 6/pi^2, L(3/2) = -4/(3 pi^2), L(5/2) = 6/(25 pi^2).
  make_weights({FilterKind::kLanczos, 3}, 0.5, weights);
  EXPECT_NEAR(weights[1] / weights[2], -2.0 / 9.0, 1e-14);
  EXPECT_NEAR(weights[0] / weights[2], 1.0 / 25.0, 1e-14);
}

/// The field at the lattice points themselves.
double eval_at_point(const Lattice& lattice, const std::vector<double>& coefficients, const CellIndex& point) {
  CellIndex cell = point;
  Vec fraction{};
  for (int axis = 0; axis < 3; ++axis) {
    if (cell[axis] + 1 < lattice.counts[axis]) continue;
    cell[axis] -= 1;
    fraction[axis] = 1.0;
  }
  CellField field(lattice);
  return field.load(coefficients, cell) ? field.eval(fraction) : kNan;
}

TEST(GridField, InterpolatingKernelsGoThroughEveryValue) {
  GridOptions options;
  options.dimensions = {6, 5, 9};
  const GridData grid = make_grid(options, tests::make_random_field(3, 4.0));
  const std::vector<double> values = make_values(grid);
  for (const Filter filter : {Filter{FilterKind::kLinear}, Filter{FilterKind::kInterpolatingBspline},
                              Filter{FilterKind::kCatmullRom}, Filter{FilterKind::kLanczos, 4}}) {
    const Lattice lattice = make_lattice(grid, filter);
    const std::vector<double> coefficients = make_coefficients(lattice, values);
    std::size_t index = 0;
    for (std::size_t k = 0; k < 9; ++k)
      for (std::size_t j = 0; j < 5; ++j)
        for (std::size_t i = 0; i < 6; ++i)
          EXPECT_NEAR(eval_at_point(lattice, coefficients, {i, j, k}), values[index++], 1e-13);
  }
}

TEST(GridField, InterpolatingBsplineStopsAtMissingValues) {
  GridOptions options;
  options.dimensions = {7, 8, 9};
  const tests::Field smooth = tests::make_random_field(4, 3.0);
  const GridData grid = make_grid(options, smooth);
  std::vector<double> values = make_values(grid);
  const std::size_t missing = 3 + 7 * (4 + 8 * 4);
  values[missing] = kNan;
  const Lattice lattice = make_lattice(grid, {FilterKind::kInterpolatingBspline});
  const std::vector<double> coefficients = make_coefficients(lattice, values);
  std::size_t missing_count = 0;
  for (const double coefficient : coefficients) missing_count += std::isnan(coefficient);
  EXPECT_EQ(missing_count, 1u);
  // Far from it the field still goes through the values: nothing leaks.
  for (std::size_t k = 0; k < 9; ++k)
    for (std::size_t j = 0; j < 8; ++j)
      EXPECT_NEAR(eval_at_point(lattice, coefficients, {0, j, k}), values[7 * (j + 8 * k)], 1e-13);
  for (std::size_t j = 0; j < 8; ++j)
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_NEAR(eval_at_point(lattice, coefficients, {i, j, 7}), values[i + 7 * (j + 8 * 7)], 1e-13);
}

Curve make_quadratic(double at_zero, double slope, double curvature) {
  double samples[4];
  for (int i = 0; i < 4; ++i) {
    const double u = sample_place(3, i);
    samples[i] = at_zero + u * (slope + u * curvature);
  }
  return fit_curve(3, samples);
}

TEST(Curve, AStraightCurveIsASegment) {
  const OpticalFunction function{
      {{0.0, 0.0, {1, 0, 0}}, {0.4, 3.0, {0, 1, 0}}, {0.4, 9.0, {0, 0, 1}}, {0.9, 0.1, {1, 1, 0}}}};
  for (const auto& [front, back] : {std::pair{-0.1, 1.2}, {0.8, 0.1}, {0.3, 0.31}, {0.4, 0.4}}) {
    RayIntegral curve, segment;
    append_curve(function, make_quadratic(front, back - front, 0.0), 0.7, curve);
    append_segment(function, front, back, 0.7, segment);
    EXPECT_NEAR(curve.optical_depth, segment.optical_depth, 1e-11);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(curve.color[k], segment.color[k], 1e-11);
  }
}

TEST(Curve, ABumpMeetsAStepTwice) {
  // s = 4 u (1 - u) is above 0.75 for u in [1/4, 3/4], where the medium is.
  const OpticalFunction function{{{0.75, 0.0, {1, 0.5, 0}}, {0.75, 2.0, {1, 0.5, 0}}}};
  RayIntegral ray;
  append_curve(function, make_quadratic(0.0, 4.0, -4.0), 3.0, ray);
  EXPECT_NEAR(ray.optical_depth, 3.0, 1e-11);
  EXPECT_NEAR(ray.color[0], -std::expm1(-3.0), 1e-11);
  EXPECT_NEAR(ray.color[1], -0.5 * std::expm1(-3.0), 1e-11);
}

TEST(Curve, ANarrowPeakOnANinthDegreeIsTheSumOfItsPieces) {
  OpticalFunction function;
  for (int i = 0; i <= 30; ++i)
    function.points.push_back({0.06 * i - 0.5, i % 3 == 1 ? 40.0 : 0.0, {0.03 * i, 1.0 - 0.03 * i, 0.5}});
  double samples[10];
  const auto scalar_at = [](double u) { return 0.3 + std::pow(u, 9) - 2.0 * std::pow(u, 5) + 0.9 * u; };
  for (int i = 0; i < 10; ++i) samples[i] = scalar_at(sample_place(9, i));
  RayIntegral exact, sum;
  append_curve(function, fit_curve(9, samples), 1.3, exact);
  constexpr int kPieces = 200000;
  for (int i = 0; i < kPieces; ++i)
    append_segment(function, scalar_at(static_cast<double>(i) / kPieces), scalar_at((i + 1.0) / kPieces), 1.3 / kPieces,
                   sum);
  EXPECT_NEAR(exact.optical_depth, sum.optical_depth, 1e-8);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(exact.color[k], sum.color[k], 1e-8);
}

const OpticalFunction kWavy{{{0.1, 0.1, {1, 0, 0}},
                             {0.45, 2.5, {0, 1, 0}},
                             {0.5, 0.2, {0, 0, 1}},
                             {0.6, 0.2, {1, 1, 0}},
                             {0.6, 1.9, {0.2, 0.7, 0.5}},
                             {0.8, 0.4, {0.2, 0.3, 0.9}}}};

std::vector<tests::NamedCamera> cameras_of_cube() { return tests::make_cameras({{{-1, 1}, {-1, 1}, {-1, 1}}}); }

TEST(GridReference, ALinearFieldIsTheMeshs) {
  const tests::Field field = [](const Vector3& p) { return 0.5 + 0.2 * p[0] - 0.1 * p[1] + 0.25 * p[2]; };
  GridOptions options;
  options.type = ScalarType::kFloat64;
  tests::BoxOptions box;
  box.type = CellType::kTetrahedron;
  const Tetrahedra tetrahedra = make_tetrahedra(tests::make_box(box, field));
  for (const auto& [name, camera] : cameras_of_cube()) {
    const View view{camera, 40, 30};
    const Image expected = draw(tetrahedra, kWavy, view);
    EXPECT_GT(tests::count_covered(expected), 300u);
    EXPECT_TRUE(images_agree(draw(make_grid(options, field), {}, kWavy, view), expected, 1e-6)) << name;
  }
}

TEST(GridReference, CellDataAreTheMeshs) {
  const tests::Field field = tests::make_random_field(5, 6.0);
  GridOptions options;
  options.dimensions = {6, 5, 8};
  options.type = ScalarType::kFloat64;
  options.association = Association::kCell;
  tests::BoxOptions box;
  box.bricks = {5, 4, 7};
  box.association = Association::kCell;
  const Tetrahedra tetrahedra = make_tetrahedra(tests::make_box(box, field));
  for (const auto& [name, camera] : cameras_of_cube()) {
    const View view{camera, 40, 30};
    const Image expected = draw(tetrahedra, kWavy, view);
    for (const FilterKind kind : {FilterKind::kLinear, FilterKind::kNearest})
      EXPECT_TRUE(images_agree(draw(make_grid(options, field), {{kind}}, kWavy, view), expected, 1e-6)) << name;
  }
}

TEST(GridReference, NearestChangesHalfwayBetweenPoints) {
  // Nearest on points is cell data whose borders lie halfway, the outermost cells half as wide.
  GridOptions options;
  options.dimensions = {5, 4, 6};
  for (int axis = 0; axis < 3; ++axis)
    options.fractions[axis] = tests::growing_fractions(options.dimensions[axis], 3.0);
  const GridData points = make_grid(options, tests::make_random_field(6, 5.0));
  GridData cells = points;
  cells.association = Association::kCell;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> at = points.shape.coordinates[axis];
    std::vector<double> borders{at.front()};
    for (std::size_t i = 1; i < at.size(); ++i) borders.push_back(0.5 * (at[i - 1] + at[i]));
    borders.push_back(at.back());
    cells.shape.coordinates[axis] = borders;
    cells.shape.dimensions[axis] += 1;
  }
  const View view{cameras_of_cube()[0].camera, 40, 30};
  EXPECT_TRUE(images_agree(draw(points, {{FilterKind::kNearest}}, kWavy, view), draw(cells, {}, kWavy, view), 1e-6));
}

TEST(GridReference, EveryFilterIsTheLimitOfFinePieces) {
  GridOptions options;
  for (int axis = 0; axis < 3; ++axis)
    options.fractions[axis] = tests::growing_fractions(options.dimensions[axis], 2.0);
  options.direction = {0.9, 0.2, 0.0, -0.3, 1.1, 0.2, 0.1, 0.0, -0.8};
  const GridData grid = make_grid(options, tests::make_random_field(7, 3.0));
  for (const Filter& filter : kAllFilters) {
    const bool is_large = filter.kind == FilterKind::kLanczos && filter.radius > 3;
    for (const auto& [name, camera] : cameras_of_cube()) {
      const View view{camera, is_large ? 8 : 16, is_large ? 6 : 12};
      const Image exact = draw(grid, {filter}, kWavy, view);
      EXPECT_GT(tests::count_covered(exact), is_large ? 5u : 15u);
      // Pieces that graze the step of the function are what is left of the fine sum's error.
      const Image fine = draw(grid, {filter, Classification::kOfField, is_large ? 600 : 1000}, kWavy, view);
      EXPECT_TRUE(images_agree(exact, fine, 1e-5))
          << name << " filter " << static_cast<int>(filter.kind) << " radius " << filter.radius;
    }
  }
}

TEST(GridReference, DirectionTurnsTheLattice) {
  // A field in the world, sampled on a lattice whose axes are exchanged and mirrored, is the same picture.
  GridOptions options, turned;
  options.dimensions = {9, 9, 9};
  turned.dimensions = {9, 9, 9};
  turned.direction = {0, -1, 0, 0, 0, 1, -1, 0, 0};
  const tests::Field field = tests::make_random_field(8, 3.0);
  const View view{cameras_of_cube()[1].camera, 30, 30};
  for (const Filter& filter : kAllFilters)
    EXPECT_TRUE(images_agree(draw(make_grid(turned, field), {filter}, kWavy, view),
                             draw(make_grid(options, field), {filter}, kWavy, view), 1e-6));
}

TEST(GridReference, MissingValuesTakeTheCellsWithinReachAway) {
  GridOptions options;
  options.dimensions = {13, 13, 13};
  const GridData grid = make_grid(options, [](const Vector3& p) {
    return std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) < 1e-9 ? std::numeric_limits<double>::infinity() : 1.0;
  });
  const OpticalFunction function{{{0.0, 0.7, {1, 1, 1}}}};
  Camera camera;
  camera.position = {0.01, 0.02, 5.0};
  camera.focal_point = {0.01, 0.02, 0.0};
  camera.parallel_scale = 1.1;
  const View view{camera, 3, 3, 1, 1, 9};  // the middle pixel
  const std::pair<Filter, double> kReaches[] = {{{FilterKind::kNearest}, 0.5},
                                                {{FilterKind::kLinear}, 1.0},
                                                {{FilterKind::kCatmullRom}, 2.0},
                                                {{FilterKind::kInterpolatingBspline}, 2.0},
                                                {{FilterKind::kLanczos, 4}, 4.0}};
  for (const auto& [filter, reach] : kReaches) {
    const Image image = draw(grid, {filter}, function, view);
    EXPECT_NEAR(image.pixels[3], -std::expm1(-0.7 * (2.0 - 2.0 * reach / 6.0)), 1e-6);
  }
}

TEST(GridReference, ClassifyingValuesIsTheSameForAStraightFunctionOfOneColour) {
  const OpticalFunction function{{{-1.0, 0.3, {0.9, 0.6, 0.3}}, {2.0, 7.0, {0.9, 0.6, 0.3}}}};
  const GridData grid = make_grid({}, tests::make_random_field(9, 2.0));
  const View view{cameras_of_cube()[0].camera, 30, 20};
  for (const Filter& filter : {Filter{FilterKind::kLinear}, Filter{FilterKind::kNearest}, Filter{FilterKind::kBspline},
                               Filter{FilterKind::kInterpolatingBspline}})
    EXPECT_TRUE(images_agree(draw(grid, {filter, Classification::kOfValues}, function, view),
                             draw(grid, {filter}, function, view), 1e-6));
}

TEST(GridReference, ValuesOfEveryType) {
  const OpticalFunction function{{{0.0, 0.0, {0, 0, 1}}, {60.0, 1.5, {0, 1, 0}}, {120.0, 0.5, {1, 0, 0}}}};
  const View view{cameras_of_cube()[0].camera, 24, 18};
  const tests::Field smooth = tests::make_random_field(10, 2.0);
  const tests::Field field = [&](const Vector3& p) { return std::nearbyint(100.0 * smooth(p)); };
  GridOptions options;
  const Image expected = draw(make_grid(options, field), {}, function, view);
  for (const ScalarType type : tests::kAllScalarTypes) {
    options.type = type;
    EXPECT_TRUE(images_agree(draw(make_grid(options, field), {}, function, view), expected, 1e-7));
    const tests::Field half = [&](const Vector3& p) { return 60.0 + 0.5 * p[0]; };
    const GridData vectors = tests::make_vector_grid(options, {half, field, half}, 1);
    EXPECT_TRUE(images_agree(draw(vectors, {}, function, view), expected, 1e-7));
  }
}

TEST(GridReference, MagnitudeIsTheLengthOfAllComponents) {
  GridOptions options;
  options.type = ScalarType::kFloat64;
  const tests::Field smooth = tests::make_random_field(11, 2.0);
  const GridData scalars = make_grid(options, [&](const Vector3& p) { return 13.0 * std::abs(smooth(p)); });
  std::vector<tests::Field> fields;
  for (const double factor : {-3.0, 4.0, 12.0})
    fields.push_back([&smooth, factor](const Vector3& p) { return factor * smooth(p); });
  const GridData vectors = tests::make_vector_grid(options, fields, kMagnitude);
  const OpticalFunction function{{{0.0, 0.0, {0, 0, 1}}, {6.0, 1.5, {0, 1, 0}}, {12.0, 0.5, {1, 0, 0}}}};
  const View view{cameras_of_cube()[0].camera, 24, 18};
  EXPECT_TRUE(images_agree(draw(vectors, {}, function, view), draw(scalars, {}, function, view), 1e-7));
}

}  // namespace
}  // namespace tetravox::reference
