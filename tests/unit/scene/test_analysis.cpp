/// Histograms and boundary functions, of grids and of meshes.

#include "tetravox/analysis.h"

#include "src/scene/differential_samples.h"
#include "src/support/threads.h"
#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"
#include "tests/unit/optics/expect_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tetravox {
namespace {

using testing::expect_error;

double radius(const Vector3& p) { return std::hypot(p[0], p[1], p[2]); }

PreparedGrid make_grid_of(const tests::Field& field, std::uint32_t points,
                          Association association = Association::kPoint) {
  tests::GridOptions options;
  options.dimensions = {points, points, points};
  options.association = association;
  return prepare_grid(tests::make_grid(options, field));
}

PreparedMesh make_mesh_of(const tests::Field& field, int bricks, Association association = Association::kPoint) {
  tests::BoxOptions options;
  options.bricks = {bricks, bricks, bricks};
  options.association = association;
  return prepare_mesh(tests::make_box(options, field));
}

double total(const std::vector<double>& counts) { return std::accumulate(counts.begin(), counts.end(), 0.0); }

/// A step from 0 to 1, blurred by a Gaussian of standard deviation `sigma`.
double blurred_step(double x, double sigma) { return 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))); }

/// Two spheres in each other: values 0 outside, 0.4 in the shell, 1 in the core.
double three_materials(const Vector3& p) {
  return 0.4 * blurred_step(0.8 - radius(p), 0.05) + 0.6 * blurred_step(0.45 - radius(p), 0.05);
}

/// Values at which the opacity has a maximum of at least half of the largest.
std::vector<double> peaks_of(const TransferFunction& function) {
  const std::vector<ControlPoint>& points = function.points;
  double largest = 0.0;
  for (const ControlPoint& point : points) largest = std::max(largest, point.absorption);
  std::vector<double> peaks;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= points.size(); ++i) {
    const bool is_opaque = i < points.size() && points[i].absorption > 0.5 * largest;
    if (is_opaque && !(points[i - 1].absorption > 0.5 * largest)) begin = i;
    if (!is_opaque && points[i - 1].absorption > 0.5 * largest)
      peaks.push_back(0.5 * (points[begin].value + points[i - 1].value));
  }
  return peaks;
}

TEST(ValueHistogram, OfALinearFieldInABoxIsFlat) {
  HistogramOptions options;
  options.bins = 50;
  const Histogram histogram = make_value_histogram(make_mesh_of([](const Vector3& p) { return p[2]; }, 3), options);
  EXPECT_EQ(histogram.range.min, -1.0);
  EXPECT_EQ(histogram.range.max, 1.0);
  for (const double share : histogram.counts) EXPECT_NEAR(share, 0.02, 1e-6);
}

TEST(ValueHistogram, CutsCellsExactly) {
  // One tetrahedron of distinct values: the distribution is a quadratic spline, known by its moments.
  tests::MeshBuilder builder;
  const std::array<double, 4> values{0.0, 1.0, 2.5, 4.0};
  const std::uint32_t a = builder.add_point({0, 0, 0}, values[0]), b = builder.add_point({1, 0, 0}, values[1]),
                      c = builder.add_point({0, 1, 0}, values[2]), d = builder.add_point({0, 0, 1}, values[3]);
  builder.add_cell(CellType::kTetrahedron, {a, b, c, d});
  HistogramOptions options;
  options.bins = 4000;
  const Histogram histogram = make_value_histogram(prepare_mesh(builder.build()), options);
  double mean = 0.0, square = 0.0;
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    const double value = (static_cast<double>(i) + 0.5) * 1e-3;
    mean += histogram.counts[i] * value;
    square += histogram.counts[i] * value * value;
  }
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  EXPECT_NEAR(total(histogram.counts), 1.0, 1e-12);
  EXPECT_NEAR(mean, sum / 4.0, 1e-5);
  EXPECT_NEAR(square, (sum * sum + sum_of_squares) / 20.0, 1e-5);
  // What lies below 1 is a corner: 1 * 1/2.5 * 1/4 of the volume.
  EXPECT_NEAR(std::accumulate(histogram.counts.begin(), histogram.counts.begin() + 1000, 0.0), 0.1, 1e-9);
}

TEST(ValueHistogram, LeavesOutWhatLiesOutsideTheRange) {
  HistogramOptions options;
  options.bins = 10;
  options.range = ValueRange{0.0, 0.5};
  const auto field = [](const Vector3& p) { return p[0]; };
  EXPECT_NEAR(total(make_value_histogram(make_mesh_of(field, 4), options).counts), 0.25, 1e-6);
  EXPECT_NEAR(total(make_value_histogram(make_grid_of(field, 41), options).counts), 0.275, 0.01);
}

TEST(ValueHistogram, OfCellDataAndOfConstantFields) {
  const auto side = [](const Vector3& p) { return p[0] < 0.0 ? 1.0 : 3.0; };
  HistogramOptions options;
  options.bins = 2;
  for (const Histogram& histogram : {make_value_histogram(make_mesh_of(side, 4, Association::kCell), options),
                                     make_value_histogram(make_grid_of(side, 5, Association::kCell), options)}) {
    EXPECT_NEAR(histogram.counts[0], 0.5, 1e-6);
    EXPECT_NEAR(histogram.counts[1], 0.5, 1e-6);
  }
  options.bins = 5;
  const auto constant = [](const Vector3&) { return 7.0; };
  EXPECT_NEAR(make_value_histogram(make_mesh_of(constant, 2), options).counts[2], 1.0, 1e-12);
  EXPECT_NEAR(make_value_histogram(make_grid_of(constant, 3), options).counts[2], 1.0, 1e-12);
}

TEST(ValueHistogram, RefusesWhatMakesNoSense) {
  const PreparedMesh mesh = make_mesh_of(radius, 2);
  HistogramOptions options;
  options.bins = 0;
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_value_histogram(mesh, options); }, "bins");
  options.bins = 5000;
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_gradient_histogram(mesh, options); }, "4096");
  options.bins = 10;
  options.range = ValueRange{1.0, 1.0};
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_value_histogram(mesh, options); }, "range");
}

/// The mean gradient magnitude and its spread.
std::pair<double, double> gradient_moments(const Histogram2D& histogram) {
  double sum = 0.0, square = 0.0, weight = 0.0;
  const double step = (histogram.other_range.max - histogram.other_range.min) / histogram.other_bins;
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    const auto row = static_cast<double>(i / static_cast<std::size_t>(histogram.bins));
    const double gradient = histogram.other_range.min + (row + 0.5) * step;
    sum += histogram.counts[i] * gradient;
    square += histogram.counts[i] * gradient * gradient;
    weight += histogram.counts[i];
  }
  EXPECT_NEAR(weight, 1.0, 2e-3);
  return {sum / weight, std::sqrt(std::max(0.0, square / weight - sum * sum / (weight * weight)))};
}

TEST(GradientHistogram, OfALinearFieldLiesAtItsSlope) {
  const auto field = [](const Vector3& p) { return 5.0 + 3.0 * p[0] + 4.0 * p[1]; };
  HistogramOptions options;
  options.other_range = ValueRange{0.0, 10.0};
  const auto [mesh_mean, mesh_spread] = gradient_moments(make_gradient_histogram(make_mesh_of(field, 4), options));
  EXPECT_NEAR(mesh_mean, 5.0, 0.05);
  EXPECT_LT(mesh_spread, 0.05);
  // On a sheared, mirrored grid with an uneven axis all the same.
  tests::GridOptions shape;
  shape.dimensions = {17, 19, 15};
  shape.direction = {0.8, 0.3, 0, 0.6, -0.9, 0.1, 0, 0.2, 1.1};
  shape.fractions[1] = tests::growing_fractions(19, 8.0);
  const PreparedGrid grid = prepare_grid(tests::make_grid(shape, field));
  const auto [mean, spread] = gradient_moments(make_gradient_histogram(grid, options));
  EXPECT_NEAR(mean, 5.0, 0.05);
  EXPECT_LT(spread, 0.05);
}

TEST(GradientHistogram, FindsItsOwnRange) {
  const Histogram2D histogram = make_gradient_histogram(make_grid_of([](const Vector3& p) { return 2.0 * p[0]; }, 9));
  EXPECT_EQ(histogram.other_range.min, 0.0);
  EXPECT_NEAR(histogram.other_range.max, 2.0, 1e-4);
  EXPECT_NEAR(total(histogram.counts), 1.0, 1e-9);
  const Histogram2D flat = make_gradient_histogram(make_mesh_of([](const Vector3&) { return 3.0; }, 2));
  EXPECT_NEAR(total(flat.counts), 1.0, 1e-9);
}

TEST(Differentials, OfAQuadraticFieldOnAnyGrid) {
  // f = r^2 / 2: the gradient is r, and along it the second derivative is 1 everywhere.
  const auto field = [](const Vector3& p) { return 0.5 * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); };
  tests::GridOptions shape;
  shape.dimensions = {21, 23, 25};
  shape.direction = {0.8, 0.3, 0, 0.6, -0.9, 0.1, 0, 0.2, 1.1};
  shape.fractions[2] = tests::growing_fractions(25, 3.0);
  const PreparedGrid grid = prepare_grid(tests::make_grid(shape, field));
  const scene::DifferentialSamples samples = scene::sample_differentials(grid, 1'000'000);
  ASSERT_EQ(samples.samples.size(), 21u * 23u * 25u);
  const double scale = grid.scalar_scale / samples.unit_length / samples.unit_length;
  std::size_t index = 0;
  for (int k = 0; k < 25; ++k)
    for (int j = 0; j < 23; ++j)
      for (int i = 0; i < 21; ++i, ++index) {
        if (std::min({i, j, k}) == 0 || i == 20 || j == 22 || k == 24) continue;
        const scene::DifferentialSample& sample = samples.samples[index];
        if (sample.gradient * scale * samples.unit_length < 0.2) continue;
        EXPECT_NEAR(sample.second * scale, 1.0, 0.02);
      }
}

TEST(Differentials, OfAQuadraticFieldOnAMesh) {
  const auto field = [](const Vector3& p) { return 0.5 * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); };
  const PreparedMesh mesh = make_mesh_of(field, 16);
  const scene::DifferentialSamples samples = scene::sample_differentials(mesh, 100'000);
  EXPECT_LE(samples.samples.size(), 100'000u + 4u);
  double mean = 0.0, volume = 0.0;
  for (const scene::DifferentialSample& sample : samples.samples) {
    mean += static_cast<double>(sample.second) * sample.volume;
    volume += sample.volume;
  }
  // Averages at the boundary's vertices are one-sided: what they see of the bend is too little.
  EXPECT_NEAR(mean / volume * mesh.scalar_scale, 1.0, 0.15);
}

TEST(Differentials, DoNotDependOnThreads) {
  const PreparedMesh mesh = make_mesh_of(three_materials, 10);
  HistogramOptions options;
  const auto with = [&](int threads) {
    Histogram2D histogram;
    support::with_threads(threads, [&] { histogram = make_gradient_histogram(mesh, options); });
    return histogram.counts;
  };
  EXPECT_EQ(with(1), with(4));
}

TEST(BoundaryFunction, OfTwoMaterialsIsOpaqueHalfWay) {
  const auto ball = [](const Vector3& p) { return 10.0 + 20.0 * blurred_step(0.6 - radius(p), 0.06); };
  for (const TransferFunction& function : {make_boundary_transfer_function(make_grid_of(ball, 65)),
                                           make_boundary_transfer_function(make_mesh_of(ball, 32))}) {
    const std::vector<double> peaks = peaks_of(function);
    ASSERT_EQ(peaks.size(), 1u);
    EXPECT_NEAR(peaks[0], 20.0, 0.6);
  }
}

TEST(BoundaryFunction, OfThreeMaterialsIsOpaqueBetweenEachTwo) {
  for (const TransferFunction& function : {make_boundary_transfer_function(make_grid_of(three_materials, 65)),
                                           make_boundary_transfer_function(make_mesh_of(three_materials, 40))}) {
    const std::vector<double> peaks = peaks_of(function);
    ASSERT_EQ(peaks.size(), 2u);
    EXPECT_NEAR(peaks[0], 0.2, 0.03);
    EXPECT_NEAR(peaks[1], 0.7, 0.03);
  }
}

TEST(BoundaryFunction, ThicknessAndRange) {
  const PreparedGrid grid = make_grid_of(three_materials, 49);
  BoundaryOptions options;
  const auto opaque_share = [&] {
    const TransferFunction function = make_boundary_transfer_function(grid, options);
    double largest = 0.0, opaque = 0.0;
    for (const ControlPoint& point : function.points) largest = std::max(largest, point.absorption);
    for (const ControlPoint& point : function.points) opaque += point.absorption > 0.3 * largest;
    return opaque / static_cast<double>(function.points.size());
  };
  options.thickness = 0.1;
  const double thin = opaque_share();
  options.thickness = 1.0;
  EXPECT_GT(opaque_share(), 2.0 * thin);
  options.range = ValueRange{0.5, 1.0};
  const TransferFunction part = make_boundary_transfer_function(grid, options);
  EXPECT_GE(part.points.front().value, 0.5);
  options.thickness = 0.0;
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_boundary_transfer_function(grid, options); }, "thickness");
}

TEST(BoundaryFunction, OfFieldsWithoutBoundaries) {
  for (const tests::Field& field :
       {tests::Field([](const Vector3&) { return 2.0; }), tests::Field([](const Vector3& p) { return p[1]; })}) {
    for (const TransferFunction& function : {make_boundary_transfer_function(make_grid_of(field, 9)),
                                             make_boundary_transfer_function(make_mesh_of(field, 4))}) {
      ASSERT_FALSE(function.points.empty());
      for (const ControlPoint& point : function.points) {
        EXPECT_TRUE(std::isfinite(point.absorption));
        EXPECT_GE(point.absorption, 0.0);
        EXPECT_LE(point.absorption, 1.0);
      }
    }
  }
}

}  // namespace
}  // namespace tetravox
