/// What lighting, surfaces and clipping may say.

#include "tests/unit/optics/expect_error.h"
#include "tetravox/clipping.h"
#include "tetravox/isosurface.h"
#include "tetravox/lighting.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tetravox {
namespace {

using testing::expect_error;

template <class Change>
void expect_bad_lighting(const Change& change, const char* member) {
  Lighting lighting;
  lighting.lights = {Light{}, Light{}};
  validate_lighting(lighting);
  change(lighting);
  expect_error(
      ErrorCode::kInvalidArgument, [&] { validate_lighting(lighting); }, member);
}

TEST(Validation, LightingNamesTheMember) {
  expect_bad_lighting([](Lighting& l) { l.lights[1].intensity = -1; }, "light 1, intensity");
  expect_bad_lighting([](Lighting& l) { l.lights[0].intensity = INFINITY; }, "light 0, intensity");
  expect_bad_lighting([](Lighting& l) { l.lights[1].color[2] = NAN; }, "light 1, color");
  expect_bad_lighting(
      [](Lighting& l) {
        l.lights[1] = {.kind = LightKind::kDirectional, .direction = {0, 0, 0}};
      },
      "light 1, direction");
  expect_bad_lighting(
      [](Lighting& l) {
        l.lights[1] = {.kind = LightKind::kPoint, .position = {0, NAN, 0}};
      },
      "light 1, position");
  const auto expect_bad_environment = [](const EnvironmentLight& light, const char* member) {
    expect_bad_lighting([&](Lighting& l) { l.environment = light; }, member);
  };
  expect_bad_environment({""}, "environment, file");
  expect_bad_environment({"a.exr", -1.0}, "environment, intensity");
  expect_bad_environment({"a.exr", INFINITY}, "environment, intensity");
  expect_bad_environment({"a.exr", 1.0, NAN}, "environment, rotation");
  expect_bad_environment({"a.exr", 1.0, 0.0, {0, 0, 0}}, "environment, up");
  expect_bad_lighting([](Lighting& l) { l.material.ambient = -0.1; }, "material, ambient");
  expect_bad_lighting([](Lighting& l) { l.material.diffuse = 1.1; }, "material, diffuse");
  expect_bad_lighting([](Lighting& l) { l.material.specular = NAN; }, "material, specular");
  expect_bad_lighting([](Lighting& l) { l.material.shininess = 0.5; }, "material, shininess");
  expect_bad_lighting([](Lighting& l) { l.gradient_threshold = -1; }, "gradient threshold");
  expect_bad_lighting([](Lighting& l) { l.shadow_resolution = 7; }, "shadow resolution");
  expect_bad_lighting([](Lighting& l) { l.shadow_resolution = 513; }, "shadow resolution");
  expect_bad_lighting([](Lighting& l) { l.ambient_occlusion = -1; }, "ambient occlusion");
  expect_bad_lighting([](Lighting& l) { l.ambient_occlusion = 1025; }, "ambient occlusion");
}

TEST(Validation, AHeadlightNeedsNeitherPlaceNorDirection) {
  Lighting lighting;
  lighting.lights = {{.direction = {0, 0, 0}, .position = {NAN, 0, 0}}};
  EXPECT_NO_THROW(validate_lighting(lighting));
}

TEST(Validation, SurfacesNameIndexAndMember) {
  const auto expect_bad = [](const Isosurface& surface, const char* member) {
    expect_error(
        ErrorCode::kInvalidArgument,
        [&] {
          validate_isosurfaces({Isosurface{}, surface});
        },
        member);
  };
  EXPECT_NO_THROW(validate_isosurfaces({}));
  EXPECT_NO_THROW(validate_isosurfaces({Isosurface{}, Isosurface{}}));
  expect_bad({.value = NAN}, "surface 1, value");
  expect_bad({.front_color = {2, 0, 0}}, "surface 1, front colour");
  expect_bad({.back_color = {0, -1, 0}}, "surface 1, back colour");
  expect_bad({.opacity = 1.5}, "surface 1, opacity");
}

TEST(Validation, ClippingNamesIndexAndMember) {
  const auto expect_bad = [](const ClipShape& shape, const char* member) {
    expect_error(
        ErrorCode::kInvalidArgument,
        [&] {
          validate_clipping({{{ClipPlane{}}, shape}});
        },
        member);
  };
  const ClipBox unit_box{{ValueRange{0, 1}, ValueRange{0, 1}, ValueRange{0, 1}}};
  EXPECT_NO_THROW(validate_clipping({}));
  EXPECT_NO_THROW(validate_clipping({{{ClipPlane{}}, {unit_box}, {ClipSphere{}}, {ClipVolume{"a.nrrd", "", 0}}}}));
  expect_bad({ClipPlane{{NAN, 0, 0}, {1, 0, 0}}}, "clip shape 1, origin");
  expect_bad({ClipPlane{{0, 0, 0}, {0, 0, 0}}}, "clip shape 1, normal");
  expect_bad({ClipBox{{ValueRange{0, 1}, ValueRange{1, 0}, ValueRange{0, 1}}}}, "clip shape 1, box");
  expect_bad({ClipBox{{ValueRange{0, 1}, ValueRange{0, 1}, ValueRange{0, NAN}}}}, "clip shape 1, box");
  expect_bad({ClipBox{{ValueRange{0, 1}, ValueRange{0, 1}, ValueRange{0, INFINITY}}}}, "clip shape 1, box");
  expect_bad({ClipSphere{{0, 0, 0}, 0}}, "clip shape 1, radius");
  expect_bad({ClipSphere{{0, INFINITY, 0}, 1}}, "clip shape 1, center");
  expect_bad({ClipVolume{"a.nrrd", "", NAN}}, "clip shape 1, value");
}

}  // namespace
}  // namespace tetravox
