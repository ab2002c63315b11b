#include "tests/unit/optics/expect_error.h"
#include "tetravox/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace tetravox {
namespace {

using testing::expect_error;
using Bounds = std::array<ValueRange, 3>;

Vector3 minus(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector3 unit(const Vector3& a) {
  const double l = std::sqrt(dot(a, a));
  return {a[0] / l, a[1] / l, a[2] / l};
}

/// Largest |x| and |y| of the corners on the picture, where 1 is its edge; infinite behind the eye.
struct Extent {
  double x = 0.0, y = 0.0;
};
Extent extent_of(const Camera& camera, const Bounds& bounds, double aspect) {
  const Vector3 forward = unit(minus(camera.focal_point, camera.position));
  const Vector3 right = unit(cross(forward, camera.view_up)), up = cross(right, forward);
  const double slope = std::tan(camera.view_angle * std::numbers::pi / 360.0);
  Extent extent;
  for (int i = 0; i < 8; ++i) {
    const Vector3 corner{(i & 1) ? bounds[0].max : bounds[0].min, (i & 2) ? bounds[1].max : bounds[1].min,
                         (i & 4) ? bounds[2].max : bounds[2].min};
    const Vector3 p = minus(corner, camera.position);
    const double z = dot(p, forward);
    if (!(z > 0.0)) return {HUGE_VAL, HUGE_VAL};
    extent.x = std::max(extent.x, std::abs(dot(p, right)) / (z * slope * aspect));
    extent.y = std::max(extent.y, std::abs(dot(p, up)) / (z * slope));
  }
  return extent;
}

TEST(DefaultCamera, ShowsAllCornersLargeForRandomBounds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-2.0, 2.0), middle(-3.0, 3.0), log_aspect(-2.0, 2.0);
  for (int round = 0; round < 2000; ++round) {
    Bounds bounds;
    for (ValueRange& range : bounds) {
      const double center = middle(random), half = std::pow(10.0, exponent(random));
      range = {center - half, center + half};
    }
    const double aspect = std::exp(log_aspect(random));
    const Camera camera = make_default_camera(bounds, aspect);
    EXPECT_NO_THROW(validate_camera(camera));
    const Extent extent = extent_of(camera, bounds, aspect);
    EXPECT_NEAR(std::max(extent.x, extent.y), 0.95, 1e-9);
    EXPECT_EQ(camera.view_up, (Vector3{0, 0, 1}));
    EXPECT_GT(camera.position[2], camera.focal_point[2]);
  }
}

TEST(DefaultCamera, HandlesFlatAndEmptyBounds) {
  for (const Bounds& bounds : {Bounds{{{0, 1}, {0, 1}, {0, 0}}},
                               {{{0, 0}, {0, 1}, {0, 1}}},
                               {{{3, 3}, {0, 1}, {5, 5}}},
                               {{{0, 0}, {0, 0}, {0, 9}}},
                               {{{0, 0}, {0, 0}, {0, 0}}},
                               {{{7, 7}, {-2, -2}, {1e7, 1e7}}},
                               {{{1e7, 1e7 + 1}, {0, 1}, {0, 1}}},
                               {{{-1e-6, 1e-6}, {0, 1e-6}, {0, 1e-6}}},
                               {{{-1e30, 1e30}, {0, 1}, {0, 1}}}}) {
    const Camera camera = make_default_camera(bounds, 1.5);
    EXPECT_NO_THROW(validate_camera(camera));
    const Extent extent = extent_of(camera, bounds, 1.5);
    EXPECT_LE(std::max(extent.x, extent.y), 0.951);
  }
}

TEST(DefaultCamera, RefusesNonsense) {
  const Bounds bounds{{{0, 1}, {0, 1}, {0, 1}}};
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_default_camera(bounds, 0.0); }, "aspect");
  expect_error(
      ErrorCode::kInvalidArgument, [&] { make_default_camera(bounds, std::nan("")); }, "aspect");
  expect_error(
      ErrorCode::kInvalidArgument,
      [&] {
        make_default_camera({{{0, 1}, {1, 0}, {0, 1}}}, 1.0);
      },
      "axis 1");
  expect_error(
      ErrorCode::kInvalidArgument,
      [&] {
        make_default_camera({{{0, 1}, {0, 1}, {0, HUGE_VAL}}}, 1.0);
      },
      "axis 2");
}

// Expected: vtkCamera of VTK 9.1, Azimuth then Elevation.
TEST(RotateCamera, AgreesWithVtk) {
  Camera camera;
  camera.position = {3, -4, 2.5};
  camera.focal_point = {0.5, 0.25, -1};
  camera.view_up = {0.1, 0.2, 1};
  struct Case {
    double azimuth, elevation;
    Vector3 position;
  };
  for (const Case& c : {Case{30, 0, {5.117418697535, -2.307510372612, 1.949760204769}},
                        Case{0, 20, {2.624750749828, -2.517052455183, 3.938760468111}},
                        Case{35, -15, {5.69727489127, -2.498033402854, 0.413911638461}},
                        Case{200, 70, {1.66700610291, 0.828163519811, 4.904771265691}}}) {
    const Camera rotated = rotate_camera(camera, c.azimuth, c.elevation);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(rotated.position[i], c.position[i], 1e-10);
    EXPECT_EQ(rotated.focal_point, camera.focal_point);
    EXPECT_EQ(rotated.view_up, camera.view_up);
  }
}

TEST(ZoomCamera, DividesAngleOrScale) {
  Camera camera;
  EXPECT_EQ(zoom_camera(camera, 1.5).view_angle, 20.0);
  EXPECT_EQ(zoom_camera(camera, 0.01).view_angle, 179.9);
  camera.parallel_scale = 6.0;
  EXPECT_EQ(*zoom_camera(camera, 1.5).parallel_scale, 4.0);
  for (const double factor : {0.0, -1.0, std::nan(""), HUGE_VAL})
    expect_error(
        ErrorCode::kInvalidArgument, [&] { zoom_camera(camera, factor); }, "zoom");
}

TEST(ValidateCamera, NamesTheMember) {
  const auto expect = [](Camera camera, const char* member) {
    expect_error(
        ErrorCode::kInvalidArgument, [&] { validate_camera(camera); }, member);
  };
  const Camera good;
  EXPECT_NO_THROW(validate_camera(good));
  Camera camera = good;
  camera.position[1] = std::nan("");
  expect(camera, "position");
  camera = good;
  camera.focal_point[1] = HUGE_VAL;
  expect(camera, "focal_point");
  camera = good;
  camera.focal_point = camera.position;
  expect(camera, "the same");
  camera = good;
  camera.view_up = {0, 0, 0};
  expect(camera, "view_up");
  camera.view_up = {0, 0, 3};
  expect(camera, "parallel to the line of sight");
  for (const double angle : {0.0, 180.0, -30.0, std::nan("")}) {
    camera = good;
    camera.view_angle = angle;
    expect(camera, "view_angle");
  }
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    camera = good;
    camera.parallel_scale = scale;
    expect(camera, "parallel_scale");
  }
}

}  // namespace
}  // namespace tetravox
