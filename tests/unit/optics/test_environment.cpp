/// Environments as data: what they may be, how they lie in the world, the embedded ones.

#include "src/optics/environment_texels.h"
#include "tests/unit/optics/expect_error.h"
#include "tetravox/environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tetravox {
namespace {

using testing::expect_error;

void expect_near(const Vector3& a, const Vector3& b) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << i;
}

TEST(Environment, EquirectangularPicturesHaveAheadInTheMiddle) {
  const auto at = [](double x, double y) {
    return optics::direction_of(EnvironmentLayout::kEquirectangular, {0, x, y});
  };
  expect_near(at(0.5, 0.5), {0, 0, 1});
  expect_near(at(0.75, 0.5), {1, 0, 0});
  expect_near(at(0.25, 0.5), {-1, 0, 0});
  expect_near(at(0.0, 0.5), {0, 0, -1});
  expect_near(at(1.0, 0.5), {0, 0, -1});
  expect_near(at(0.3, 0.0), {0, 1, 0});
  expect_near(at(0.3, 1.0), {0, -1, 0});
}

TEST(Environment, FacesOfCubesAreSeenUprightFromInside) {
  const auto at = [](int face, double x, double y) {
    return optics::direction_of(EnvironmentLayout::kCube, {face, x, y});
  };
  const Vector3 middles[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int face = 0; face < 6; ++face) expect_near(at(face, 0.5, 0.5), middles[face]);
  // Neighbours meet: ahead's right edge is the left one of right, and so on around.
  for (const double t : {0.0, 0.3, 1.0}) {
    expect_near(at(4, 1, t), at(0, 0, t));
    expect_near(at(0, 1, t), at(5, 0, t));
    expect_near(at(5, 1, t), at(1, 0, t));
    expect_near(at(1, 1, t), at(4, 0, t));
    expect_near(at(2, t, 1), at(4, t, 0));      // up's lower edge is ahead's upper one
    expect_near(at(2, t, 0), at(5, 1 - t, 0));  // its upper one meets behind
    expect_near(at(3, t, 0), at(4, t, 1));      // down's upper edge is ahead's lower one
  }
}

TEST(Environment, SolidAnglesAddUpToTheSphere) {
  // In units in which a face is 1: 2 pi^2 sin for the picture, 4 (1 + s^2 + t^2)^(-3/2) for a face.
  for (const bool is_cube : {false, true}) {
    double sum = 0.0;
    constexpr int kSteps = 200;
    for (int y = 0; y < kSteps; ++y)
      for (int x = 0; x < kSteps; ++x)
        sum += optics::spread_of(is_cube ? EnvironmentLayout::kCube : EnvironmentLayout::kEquirectangular,
                                 {0, (x + 0.5) / kSteps, (y + 0.5) / kSteps}) /
               kSteps / kSteps;
    const double pi = std::numbers::pi;
    EXPECT_NEAR(is_cube ? 6.0 * 4.0 * sum : 2.0 * pi * pi * sum, 4.0 * pi, 1e-3);
  }
}

TEST(Environment, AxesAreARightHandedFrame) {
  expect_near(environment_axes({0, 0, 2}, 0)[0], {1, 0, 0});
  expect_near(environment_axes({0, 0, 2}, 0)[2], {0, 1, 0});
  expect_near(environment_axes({0, 1, 0}, 0)[2], {0, 0, -1});
  expect_near(environment_axes({0, 0, 1}, 90)[0], {0, 1, 0});
  expect_near(environment_axes({0, 0, 1}, 90)[2], {-1, 0, 0});
  for (const Vector3& up : {Vector3{1, 0, 0}, Vector3{-3, 0.1, 0}, Vector3{1, 2, -3}, Vector3{0, 0, -1}})
    for (const double rotation : {0.0, 33.0, -500.0}) {
      const auto [right, top, ahead] = environment_axes(up, rotation);
      const double length = std::hypot(up[0], up[1], up[2]);
      expect_near(top, {up[0] / length, up[1] / length, up[2] / length});
      expect_near(ahead, {top[1] * right[2] - top[2] * right[1], top[2] * right[0] - top[0] * right[2],
                          top[0] * right[1] - top[1] * right[0]});
      EXPECT_NEAR(std::hypot(right[0], right[1], right[2]), 1.0, 1e-12);
      EXPECT_NEAR(right[0] * top[0] + right[1] * top[1] + right[2] * top[2], 0.0, 1e-12);
    }
  expect_error(
      ErrorCode::kInvalidArgument,
      [] {
        environment_axes({0, 0, 0}, 0);
      },
      "up", "not all 0");
}

TEST(Environment, WhatIsWrongIsNamed) {
  const auto expect_bad = [](const Environment& environment, const char* what) {
    expect_error(
        ErrorCode::kInvalidArgument, [&] { validate_environment(environment); }, "environment", what);
  };
  const auto make = [](EnvironmentLayout layout, int width, int height, std::size_t count) {
    return Environment{layout, width, height, std::vector<float>(count)};
  };
  const auto kPicture = EnvironmentLayout::kEquirectangular, kCube = EnvironmentLayout::kCube;
  validate_environment(make(kPicture, 2, 1, 6));
  validate_environment(make(kCube, 1, 1, 18));
  expect_bad({}, "at least 1");
  expect_bad(make(kPicture, 3, 2, 18), "twice as wide");
  expect_bad(make(kCube, 2, 1, 36), "square");
  expect_bad(make(kPicture, 2, 1, 5), "needs 6 numbers and has 5");
  expect_bad(make(kPicture, 16384, 8192, 0), "at most");
  expect_bad(make(kPicture, 2147483646, 1073741823, 0), "at most");
  Environment bad = make(kCube, 2, 2, 72);
  bad.radiance[3 * 13] = NAN;  // face 3: column 1, row 0
  expect_bad(bad, "column 1, row 0, face 3");
  bad.radiance[3 * 13] = -1.0f;
  expect_bad(bad, "-1");
  bad.radiance[3 * 13] = INFINITY;
  expect_bad(bad, "inf");
}

TEST(Environment, EmbeddedOnesAreValid) {
  const auto names = builtin_environment_names();
  EXPECT_GE(names.size(), 5u);
  for (const auto& [name, description] : names) {
    const Environment environment = make_builtin_environment("builtin:" + name);
    EXPECT_NO_THROW(validate_environment(environment)) << name;
    EXPECT_EQ(make_builtin_environment(name).radiance, environment.radiance);
    EXPECT_FALSE(description.empty());
    double sum = 0.0;
    for (const float value : environment.radiance) sum += value;
    const double mean = sum / static_cast<double>(environment.radiance.size());
    EXPECT_GT(mean, 0.2) << name;  // none is so dark or bright that pictures are of no use
    EXPECT_LT(mean, 1.5) << name;
  }
  expect_error(
      ErrorCode::kInvalidArgument, [] { make_builtin_environment("builtin:moon"); }, "'moon'", "studio", "sky");
}

TEST(Environment, TheSkyIsBlueAndItsSunIsWhereItIs) {
  const Environment sky = make_builtin_environment("sky");
  const auto texel = [&](double x, double y) {
    return sky.radiance.data() +
           3 * (static_cast<std::size_t>(y * sky.height) * sky.width + static_cast<std::size_t>(x * sky.width));
  };
  const float* away = texel(0.5, 0.2);  // ahead; the sun stands behind
  EXPECT_GT(away[2], 1.5f * away[0]);
  EXPECT_GT(away[0], 0.02f);
  const std::size_t brightest =
      static_cast<std::size_t>(std::max_element(sky.radiance.begin(), sky.radiance.end()) - sky.radiance.begin());
  const double x = (static_cast<double>(brightest / 3 % sky.width) + 0.5) / sky.width;
  const double y = (static_cast<double>(brightest / 3 / sky.width) + 0.5) / sky.height;
  const Vector3 sun = optics::direction_of(sky.layout, {0, x, y});
  const double length = std::sqrt(0.55 * 0.55 + 0.75 * 0.75 + 0.8 * 0.8);
  EXPECT_GT((-0.55 * sun[0] + 0.75 * sun[1] - 0.8 * sun[2]) / length, 0.999);
}

}  // namespace
}  // namespace tetravox
