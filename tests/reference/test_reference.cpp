/// The reference held against closed forms, so that it may judge the renderer.

#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"
#include "tests/reference/integrator.h"
#include "tests/reference/segment.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tetravox::reference {
namespace {

using tetravox::tests::BoxOptions;
using tetravox::tests::make_box;

TEST(Segment, ConstantExtinctionHasTheClosedForm) {
  const OpticalFunction function{{{0.0, 2.0, {0.5, 1.0, 0.25}}}};
  RayIntegral ray;
  append_segment(function, 0.3, 0.3, 1.5, ray);
  EXPECT_DOUBLE_EQ(ray.optical_depth, 3.0);
  EXPECT_NEAR(ray.color[0], 0.5 * (1.0 - std::exp(-3.0)), 1e-14);
  EXPECT_NEAR(ray.color[1], 1.0 - std::exp(-3.0), 1e-14);
}

TEST(Segment, WhiteGathersItsOpacityWhateverTheExtinction) {
  OpticalFunction function;
  for (int i = 0; i <= 40; ++i)
    function.points.push_back({0.025 * i, 30.0 * std::pow(std::sin(1.3 * i), 2), {1, 1, 1}});
  for (const auto& [front, back] : {std::pair{0.0, 1.0}, {1.0, 0.0}, {-0.5, 1.5}, {0.31, 0.32}, {1.5, 0.2}}) {
    RayIntegral ray;
    append_segment(function, front, back, 0.37, ray);
    append_segment(function, back, front, 0.11, ray);
    EXPECT_NEAR(ray.color[0], -std::expm1(-ray.optical_depth), 1e-12) << front << " to " << back;
  }
}

TEST(Segment, ASegmentIsTheSumOfItsParts) {
  const OpticalFunction function{
      {{0.0, 0.0, {1, 0, 0}}, {0.4, 3.0, {0, 1, 0}}, {0.4, 9.0, {0, 0, 1}}, {0.9, 0.1, {1, 1, 0}}}};
  RayIntegral whole, parts;
  append_segment(function, 0.95, -0.05, 2.0, whole);
  double scalar = 0.95;
  for (const double next : {0.9, 0.7, 0.4, 0.39, 0.0, -0.05}) {
    append_segment(function, scalar, next, 2.0 * (scalar - next), parts);
    scalar = next;
  }
  EXPECT_NEAR(whole.optical_depth, parts.optical_depth, 1e-13);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(whole.color[k], parts.color[k], 1e-13);
}

TEST(Segment, LinearExtinctionAndColourMatchFineSums) {
  const OpticalFunction function{{{0.0, 1.0, {0.0, 0.2, 0.9}}, {1.0, 5.0, {1.0, 0.4, 0.1}}}};
  RayIntegral ray;
  append_segment(function, 0.0, 1.0, 2.0, ray);
  Color sum{};
  const int steps = 200000;
  for (int i = 0; i < steps; ++i) {
    const double u = (i + 0.5) / steps;
    const double weight = (1.0 + 4.0 * u) * std::exp(-2.0 * (u + 2.0 * u * u)) * 2.0 / steps;
    for (int k = 0; k < 3; ++k)
      sum[k] += weight * (function.points[0].color[k] * (1.0 - u) + function.points[1].color[k] * u);
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(ray.color[k], sum[k], 1e-9);
  EXPECT_DOUBLE_EQ(ray.optical_depth, 6.0);
}

class ReferenceCells : public ::testing::TestWithParam<CellType> {};

TEST_P(ReferenceCells, ABoxOfLinearFieldIsTheSameInAnyCells) {
  const auto field = [](const Vector3& p) { return 0.4 + 0.2 * p[0] - 0.1 * p[1] + 0.25 * p[2]; };
  const OpticalFunction function{{{0.0, 0.1, {1, 0, 0}}, {0.5, 1.5, {0, 1, 0}}, {0.8, 0.2, {0, 0, 1}}}};
  View view;
  view.camera.position = {2.5, 3.0, 4.0};
  view.camera.view_angle = 40.0;
  view.width = 40;
  view.height = 30;
  BoxOptions one;
  one.bricks = {1, 1, 1};
  one.type = CellType::kTetrahedron;
  BoxOptions many;
  many.bricks = {3, 4, 5};
  many.type = GetParam();
  const Image expected = draw(make_tetrahedra(make_box(one, field)), function, view);
  const Image actual = draw(make_tetrahedra(make_box(many, field)), function, view);
  EXPECT_GT(tetravox::tests::count_covered(expected), 300u);
  EXPECT_TRUE(tetravox::tests::images_agree(actual, expected, 1e-6));
}

INSTANTIATE_TEST_SUITE_P(AllTypes, ReferenceCells,
                         ::testing::Values(CellType::kTetrahedron, CellType::kVoxel, CellType::kHexahedron,
                                           CellType::kWedge, CellType::kPyramid, CellType::kPolyhedron));

TEST(Reference, AMissingValueTakesItsCellsAway) {
  BoxOptions options;
  options.bricks = {2, 1, 1};
  const auto field = [](const Vector3& p) { return p[0] > 0.5 ? std::nan("") : 1.0; };
  const Tetrahedra tetrahedra = make_tetrahedra(make_box(options, field));
  for (const Tetrahedron& cell : tetrahedra.cells) EXPECT_EQ(cell.input_cell, 0u);
  EXPECT_GE(tetrahedra.cells.size(), 5u);
}

TEST(Reference, SubsetOfPixelsIsTheWholePicturesPixels) {
  const auto field = [](const Vector3& p) { return p[0] * p[1] + p[2]; };
  const Tetrahedra tetrahedra = make_tetrahedra(make_box({}, field));
  const OpticalFunction function{{{-1.0, 0.0, {1, 0, 0}}, {1.0, 1.0, {0, 1, 1}}}};
  View whole;
  whole.camera.position = {0.3, 0.2, 0.1};  // inside
  whole.camera.focal_point = {2.0, 1.0, 0.5};
  whole.camera.view_angle = 90.0;
  View part = whole;
  part.first_x = 3;
  part.first_y = 2;
  part.stride = 5;
  EXPECT_TRUE(tetravox::tests::images_agree(draw(tetrahedra, function, part),
                                            pick_pixels(draw(tetrahedra, function, whole), part), 1e-6));
}

}  // namespace
}  // namespace tetravox::reference
