/// The picture does not depend on where a mesh or grid lies, how large it is, or what its values are measured in.

#include "tests/analytic/closed_form.h"
#include "tests/common/body.h"
#include "tests/common/draw.h"
#include "tests/common/grid_builder.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"

#include <cmath>

namespace tetravox::analytic {
namespace {

using tests::images_agree;
using tests::make_settings;

double wavy_field(const Vector3& p) {
  return std::sin(3.0 * p[0] + 1.0) * std::cos(2.0 * p[1]) + 0.7 * std::sin(4.0 * p[2] * p[0]);
}

MeshData make_wavy_box() {
  tests::BoxOptions options;
  options.bricks = {9, 8, 7};
  return tests::make_box(options, wavy_field);
}

GridData make_wavy_grid() {
  tests::GridOptions options;
  options.dimensions = {20, 18, 15};
  return tests::make_grid(options, wavy_field);
}

/// Opacities for the automatic unit distance: the diagonal of the bounds over 100.
OpticalFunction make_function(const tests::Body& body) {
  double squares = 0.0;
  for (const ValueRange& range : body.bounds()) squares += (range.max - range.min) * (range.max - range.min);
  TransferFunction function{{{-1.5, {0.1, 0.2, 0.9}, 0.0},
                             {-0.4, {0.2, 0.9, 0.5}, 0.15},
                             {0.1, {0.9, 0.8, 0.2}, 0.01},
                             {0.9, {0.9, 0.2, 0.1}, 0.3}},
                            Absorption::kOpacity,
                            std::nullopt};
  return make_optical_function(function, std::sqrt(squares) / 100.0);
}

Camera transform_camera(Camera camera, double factor, const Vector3& centre) {
  for (int k = 0; k < 3; ++k) {
    camera.position[k] = centre[k] + factor * camera.position[k];
    camera.focal_point[k] = centre[k] + factor * camera.focal_point[k];
  }
  if (camera.parallel_scale) *camera.parallel_scale *= factor;
  return camera;
}

struct Frame {
  const char* name;
  double factor;
  Vector3 centre;
};

void PrintTo(const Frame& frame, std::ostream* out) { *out << frame.name; }

class Frames : public ::testing::TestWithParam<Frame> {};

/// Draws a body and the same moved, each with a function for its size.
void expect_same(const tests::Body& body, const tests::Body& moved, const Frame& frame, double bound) {
  for (const auto& [name, camera] : standard_cameras()) {
    for (const Integrator integrator : tests::kAllIntegrators) {
      const RenderSettings settings = make_settings(integrator, 80, 60);
      const Image expected = body.draw(make_function(body), camera, settings);
      const Image actual =
          moved.draw(make_function(moved), transform_camera(camera, frame.factor, frame.centre), settings);
      EXPECT_GT(tests::count_covered(expected), 1000u);
      EXPECT_TRUE(images_agree(actual, expected, bound)) << frame.name << " " << name << " " << name_of(integrator);
    }
  }
}

TEST_P(Frames, ThePictureOfAMeshIsTheSame) {
  const MeshData mesh = make_wavy_box();
  expect_same(mesh, tests::transform_mesh(mesh, GetParam().factor, GetParam().centre), GetParam(), 1e-3);
}

TEST_P(Frames, ThePictureOfAGridIsTheSame) {
  const GridData grid = make_wavy_grid();
  expect_same(grid, tests::transform_grid(grid, GetParam().factor, GetParam().centre), GetParam(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(All, Frames,
                         ::testing::Values(Frame{"moved_by_1e7", 1.0, {1e7, -1e7, 1e7}},
                                           Frame{"small", 1e-6, {0, 0, 0}}, Frame{"large", 1e6, {0, 0, 0}},
                                           Frame{"small_and_moved", 1e-3, {200.0, 300.0, -100.0}},
                                           Frame{"tiny", 1e-30, {0, 0, 0}}, Frame{"huge", 1e30, {0, 0, 0}}),
                         [](const auto& test) { return test.param.name; });

struct Values {
  const char* name;
  double factor, offset;
};

void PrintTo(const Values& values, std::ostream* out) { *out << values.name; }

class ValueFrames : public ::testing::TestWithParam<Values> {};

/// Draws two bodies, the second with values factor * v + offset.
void expect_same_values(const tests::Body& expected, const tests::Body& actual, const Values& values) {
  OpticalFunction function{
      {{-1.0, 0.0, {0, 0, 1}}, {0.0, 2.0, {0, 1, 0}}, {0.3, 0.1, {1, 0, 0}}, {1.0, 3.0, {1, 1, 1}}}};
  OpticalFunction shifted = function;
  for (OpticalPoint& point : shifted.points) point.value = values.offset + values.factor * point.value;
  for (const auto& [name, camera] : standard_cameras()) {
    for (const Integrator integrator : tests::kExactIntegrators) {
      const RenderSettings settings = make_settings(integrator, 80, 60);
      EXPECT_TRUE(images_agree(actual.draw(shifted, camera, settings), expected.draw(function, camera, settings), 1e-3))
          << values.name << " " << name << " " << name_of(integrator);
    }
  }
}

TEST_P(ValueFrames, ThePictureIsTheSame) {
  const auto shifted_field = [&](const Vector3& p) { return GetParam().offset + GetParam().factor * wavy_field(p); };
  expect_same_values(tests::make_box({}, wavy_field), tests::make_box({}, shifted_field), GetParam());
  tests::GridOptions options;
  options.type = ScalarType::kFloat64;
  expect_same_values(tests::make_grid(options, wavy_field), tests::make_grid(options, shifted_field), GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, ValueFrames,
                         ::testing::Values(Values{"kelvin", 1.0, 1e5}, Values{"pascal", 1e-2, 101325.0},
                                           Values{"small", 1e-20, 0.0}, Values{"large", 1e20, 0.0},
                                           Values{"far", 1.0, -1e9}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace tetravox::analytic
