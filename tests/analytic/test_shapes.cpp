/// Parts, holes, non-convex outlines, missing values, a ball: chords through a homogeneous medium.

#include "tests/analytic/closed_form.h"
#include "tests/common/draw.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::analytic {
namespace {

using tests::BoxOptions;
using tests::make_box;
using tests::make_settings;

const Color kColor{0.9, 0.6, 0.3};
constexpr double kExtinction = 0.8;
const OpticalFunction kHomogeneous{{{0.0, kExtinction, kColor}}};

double one(const Vector3&) { return 1.0; }

class Shapes : public ::testing::TestWithParam<Integrator> {
 protected:
  /// Draws `mesh` from all standard cameras; `length` says how much of a ray lies inside.
  void expect_lengths(const MeshData& mesh, const std::function<double(const Ray&)>& length,
                      const Tolerance& tolerance = {}) const {
    const PreparedMesh prepared = prepare_mesh(mesh);
    for (const auto& [name, camera] : standard_cameras()) {
      const Image image = render(prepared, kHomogeneous, camera, make_settings(GetParam(), 67, 51));
      EXPECT_TRUE(shows(
          image, camera, [&](const Ray& ray) { return fill(kColor, kExtinction * length(ray)); }, tolerance))
          << name;
    }
  }
};

TEST_P(Shapes, TwoPartsAreSeenOneThroughTheOther) {
  tests::MeshBuilder builder;
  BoxOptions left, right;
  left.upper = {-0.3, 0.8, 0.9};
  right.lower = {0.2, -0.9, -1.1};
  right.type = CellType::kTetrahedron;
  tests::add_box(builder, left, one);
  tests::add_box(builder, right, one);
  expect_lengths(builder.build(), [&](const Ray& ray) {
    return intersect_box(ray, left.lower, left.upper).length() + intersect_box(ray, right.lower, right.upper).length();
  });
}

TEST_P(Shapes, AHoleIsEmpty) {
  BoxOptions options;
  options.bricks = {5, 5, 5};
  options.is_hole = [](int i, int j, int k) { return i >= 1 && i < 3 && j >= 2 && j < 4 && k >= 1 && k < 4; };
  expect_lengths(make_box(options, one), [](const Ray& ray) {
    return intersect_box(ray, {-1, -1, -1}, {1, 1, 1}).length() -
           intersect_box(ray, {-0.6, -0.2, -0.6}, {0.2, 0.6, 0.6}).length();
  });
}

TEST_P(Shapes, ABentOutlineIsLeftAndEnteredAgain) {
  BoxOptions options;
  options.bricks = {6, 4, 5};
  options.type = CellType::kWedge;
  options.is_hole = [](int i, int j, int) { return (i == 1 || i == 3) && j >= 1; };
  expect_lengths(make_box(options, one), [](const Ray& ray) {
    const double third = 1.0 / 3.0;
    return intersect_box(ray, {-1, -1, -1}, {1, 1, 1}).length() -
           intersect_box(ray, {-2 * third, -0.5, -1}, {-third, 1, 1}).length() -
           intersect_box(ray, {0.0, -0.5, -1}, {third, 1, 1}).length();
  });
}

TEST_P(Shapes, CornersWithoutAValueTakeTheirCellsAndNothingElse) {
  // The point at the middle is a corner of eight bricks, the point at the box's corner of one.
  const auto field = [](const Vector3& p) {
    const bool is_middle = std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) < 1e-9;
    const bool is_corner = p[0] + p[1] + p[2] > 3.0 - 1e-9;
    if (is_middle) return std::numeric_limits<double>::quiet_NaN();
    return is_corner ? std::numeric_limits<double>::infinity() : 1.0;
  };
  expect_lengths(make_box({}, field), [](const Ray& ray) {
    return intersect_box(ray, {-1, -1, -1}, {1, 1, 1}).length() -
           intersect_box(ray, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}).length() -
           intersect_box(ray, {0.5, 0.5, 0.5}, {1, 1, 1}).length();
  });
}

TEST_P(Shapes, CellsWithoutAValueAreEmpty) {
  BoxOptions options;
  options.association = Association::kCell;
  const auto field = [](const Vector3& p) {
    return p[0] > 0.5 && p[1] > 0.5 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  };
  expect_lengths(make_box(options, field), [](const Ray& ray) {
    return intersect_box(ray, {-1, -1, -1}, {1, 1, 1}).length() -
           intersect_box(ray, {0.5, 0.5, -1}, {1, 1, 1}).length();
  });
}

/// A ball of n^3 bricks: each point of the cube is pulled in to the sphere of its layer.
MeshData make_ball(int n) {
  BoxOptions options;
  options.bricks = {n, n, n};
  const MeshData cube = make_box(options, one);
  tests::MeshBuilder builder;
  for (std::size_t i = 0; i < cube.point_count(); ++i) {
    Vector3 p{cube.points[3 * i], cube.points[3 * i + 1], cube.points[3 * i + 2]};
    const double length = std::hypot(p[0], p[1], p[2]);
    const double layer = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
    for (double& x : p) x *= length > 0.0 ? layer / length : 0.0;
    builder.add_point(p, 1.0);
  }
  for (std::size_t cell = 0; cell < cube.cell_count(); ++cell) {
    const auto ids = cube.connectivity.subspan(8 * cell, 8);
    builder.add_cell(CellType::kHexahedron, {ids.begin(), ids.end()});
  }
  return builder.build();
}

/// RMS difference of opacity between the ball and a sphere's chords.
double ball_error(int n, const Camera& camera, Integrator integrator) {
  const Image image = tests::draw(make_ball(n), kHomogeneous, camera, make_settings(integrator, 64, 64));
  double sum = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Ray ray = make_ray(camera, 64, 64, x, y);
      double middle = 0.0, distance2 = 0.0;
      for (int k = 0; k < 3; ++k) middle -= ray.origin[k] * ray.direction[k];
      for (const double p : ray.at(middle)) distance2 += p * p;
      const double half = std::sqrt(std::max(0.0, 1.0 - distance2));
      const double length = std::max(0.0, middle + half) - std::max(0.0, middle - half);
      const double error = image.pixel(x, y)[3] + std::expm1(-kExtinction * length);
      sum += error * error;
    }
  }
  return std::sqrt(sum / (64.0 * 64.0));
}

TEST_P(Shapes, ABallHasTheChordsOfASphere) {
  for (const auto& [name, camera] : standard_cameras()) {
    const double coarse = ball_error(8, camera, GetParam());
    const double fine = ball_error(24, camera, GetParam());
    EXPECT_LT(fine, 5e-3) << name;
    EXPECT_LT(fine, coarse / 4.0) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Shapes, ::testing::ValuesIn(tests::kAllIntegrators),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace tetravox::analytic
