/// Lit volumes: against the model in double precision, and what must not change a picture.

#include "tests/analytic/lit.h"
#include "tests/analytic/show.h"
#include "tests/common/functions.h"
#include "tests/common/grid_builder.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace tetravox::analytic {
namespace {

double square_norm(const Vector3& p) { return dot(p, p); }

TEST_P(Lit, LinearFieldHasTheModelsLight) {
  const tests::Body body = cube(12, linear_field);
  const double range = body.scalar_range().max - body.scalar_range().min;
  for (const double threshold : {0.0, 2.0}) {
    for (const bool is_two_sided : {true, false}) {
      RenderSettings settings = make_settings(1e-5);
      settings.lighting = make_lights();
      settings.lighting.gradient_threshold = threshold;
      settings.lighting.is_two_sided = is_two_sided;
      const double half = threshold * range / tests::diagonal_of(body.bounds());
      const double g = norm(kSlope), strength = g * g / (g * g + half * half);
      expect_shown(
          body, kHomogeneous, settings,
          [&](const Ray& ray) {
            return integrate_lit(ray, intersect_box(ray, kLower, kUpper), kColor, [&](const Vector3& place) {
              return illuminate(settings.lighting, ray.direction, place, kSlope, strength);
            });
          },
          {is_grid() ? 1e-3 : 2e-4, 1e-5});  // a stretch is lit in one place; in grids it may be two cells long
    }
  }
}

TEST_P(Lit, TheEyesLightShinesByEveryExponent) {
  const tests::Body body = cube(9, linear_field);
  const double range = body.scalar_range().max - body.scalar_range().min;
  RenderSettings settings = make_settings(1e-5);
  settings.lighting.lights = {Light{}};
  settings.lighting.material = {0.2, 0.5, 0.8, 1.0};
  const double half = settings.lighting.gradient_threshold * range / tests::diagonal_of(body.bounds());
  const double g = norm(kSlope), strength = g * g / (g * g + half * half);
  for (const double shininess : {1.0, 2.0, 7.0, 7.5, 32.0, 33.0, 256.0, 257.0}) {
    settings.lighting.material.shininess = shininess;
    expect_shown(body, kHomogeneous, settings,
                 [&](const Ray& ray) {
                   return integrate_lit(ray, intersect_box(ray, kLower, kUpper), kColor, [&](const Vector3& place) {
                     return illuminate(settings.lighting, ray.direction, place, kSlope, strength);
                   });
                 },
                 {2e-4, 2e-5});
  }
}

TEST_P(Lit, EveryGradientMethodFindsALinearFieldsSlope) {
  const tests::Body body = cube(9, linear_field);
  const std::vector<GradientMethod> methods = is_grid() ? std::vector{GradientMethod::kFilter, GradientMethod::kCentral}
                                                        : std::vector{GradientMethod::kVertex, GradientMethod::kCell};
  RenderSettings settings = make_settings(1e-5);
  settings.lighting = make_lights();
  const Camera camera = standard_cameras()[0].second;
  const Image usual = body.draw(kHomogeneous, camera, settings);
  for (const GradientMethod method : methods) {
    settings.lighting.gradient = method;
    EXPECT_TRUE(tests::images_agree(body.draw(kHomogeneous, camera, settings), usual, 2e-5)) << name_of(method);
  }
}

TEST_P(Lit, SphereHasTheModelsLight) {
  // The gradient of a distance points away from the middle. Near that it is not what any lattice finds: left out there.
  const double radius = 0.8, inner = 0.3;
  RenderSettings settings = make_settings(1e-4);
  settings.lighting = make_lights();
  settings.lighting.gradient_threshold = 0.0;
  settings.clipping.shapes = {{ClipSphere{{0, 0, 0}, radius}, true}, {ClipSphere{{0, 0, 0}, inner}, false}};
  const auto chord_of = [](const Ray& ray, double r) {
    const double nearest = -dot(ray.origin, ray.direction);
    const double half = std::sqrt(std::max(0.0, r * r - (square_norm(ray.origin) - nearest * nearest)));
    return Chord{std::max(0.0, nearest - half), std::max(0.0, nearest + half)};
  };
  for (const auto& field : {tests::Field(norm), tests::Field(square_norm)}) {
    expect_shown(cube(is_grid() ? 64 : 40, field), kHomogeneous, settings,
                 [&](const Ray& ray) {
                   const auto light_at = [&](const Vector3& place) {
                     return illuminate(settings.lighting, ray.direction, place, place, 1.0);
                   };
                   const Chord whole = chord_of(ray, radius), hole = chord_of(ray, inner);
                   if (hole.length() == 0.0) return integrate_lit(ray, whole, kColor, light_at);
                   return over(integrate_lit(ray, {whole.near, hole.near}, kColor, light_at),
                               integrate_lit(ray, {hole.far, whole.far}, kColor, light_at));
                 },
                 {2e-3, 1e-4});
  }
}

TEST_P(Lit, SphereOfAStepHasTheModelsLight) {
  // As above, but the function ends the sphere: constant inside the radius, nothing outside. Rays near the border are
  // left out by darkness alone, so the whole is compared where it is thick.
  const double radius = 0.8;
  RenderSettings settings = make_settings(1e-4);
  settings.lighting = make_lights();
  settings.lighting.gradient_threshold = 0.0;
  const OpticalFunction function{
      {{0.0, kExtinction, kColor}, {radius, kExtinction, kColor}, {radius, 0.0, kColor}, {2.0, 0.0, kColor}}};
  const tests::Body body = cube(is_grid() ? 64 : 40, norm);
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = body.draw(function, camera, settings);
    double worst = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Ray ray = make_ray(camera, image.width, image.height, x, y);
        const double nearest = -dot(ray.origin, ray.direction);
        const double off = std::sqrt(square_norm(ray.origin) - nearest * nearest);
        if (off > 0.9 * radius || off < 0.15) continue;
        const double half = std::sqrt(radius * radius - off * off);
        const Chord chord{std::max(0.0, nearest - half), std::max(0.0, nearest + half)};
        const Rgba wanted = integrate_lit(ray, chord, kColor, [&](const Vector3& place) {
          return illuminate(settings.lighting, ray.direction, place, place, 1.0);
        });
        for (int k = 0; k < 4; ++k) worst = std::max(worst, std::abs(image.pixel(x, y)[k] - wanted[k]));
      }
    EXPECT_LT(worst, 4e-3) << name;
  }
}

TEST_P(Lit, OpacityFollowsTheScalarsChange) {
  const tests::Body body = cube(9, linear_field);
  const double range = body.scalar_range().max - body.scalar_range().min;
  const double unit = tests::diagonal_of(body.bounds()) / range;
  RenderSettings settings = make_settings(1e-5);
  for (const OpacityWeight kind : {OpacityWeight::kScalarDifference, OpacityWeight::kGradient})
    for (const double scale : {0.1, 0.4, 2.0}) {  // some, many, all rays at full weight
      settings.opacity_weight = kind;
      settings.opacity_weight_scale = scale;
      expect_shown(body, kHomogeneous, settings,
                   [&](const Ray& ray) {
                     const double rate =
                         kind == OpacityWeight::kGradient ? norm(kSlope) : std::abs(dot(kSlope, ray.direction));
                     const double weight = std::min(1.0, scale * rate * unit);
                     return fill(kColor, kExtinction * weight * intersect_box(ray, kLower, kUpper).length());
                   },
                   {3e-5, 3e-5});
    }
}

/// A body with much to see.
const tests::Field& waves() {
  static const tests::Field field = tests::make_random_field(11, 2.0);
  return field;
}

OpticalFunction smooth_function() {
  return {{{0.2, 0.0, {0.1, 0.2, 0.9}}, {0.5, 3.0, {0.9, 0.7, 0.2}}, {0.9, 0.7, {0.9, 0.1, 0.1}}}};
}

TEST_P(Lit, AmbientLightAloneIsNoLight) {
  const tests::Body body = cube(14, waves());
  RenderSettings settings = make_settings(1e-6);
  for (const auto& [name, camera] : standard_cameras()) {
    settings.lighting = {};
    const Image unlit = body.draw(smooth_function(), camera, settings);
    settings.lighting = make_lights();
    settings.lighting.material = {1.0, 0.0, 0.0, 12.0};
    EXPECT_TRUE(tests::images_agree(body.draw(smooth_function(), camera, settings), unlit, 1e-5)) << name;
    // What has no gradient to speak of is lit from everywhere.
    settings.lighting.lights = {directional({1, 2, 3})};
    settings.lighting.material = {0.4, 0.6, 0.5, 12.0};
    settings.lighting.gradient_threshold = 1e6;
    EXPECT_TRUE(tests::images_agree(body.draw(smooth_function(), camera, settings), unlit, 1e-5)) << name;
  }
}

/// Rotation by Rodrigues' formula about (1, 2, 3).
Vector3 turn(const Vector3& p) {
  const Vector3 axis = normalized({1, 2, 3});
  const double c = std::cos(0.7), s = std::sin(0.7), along = dot(axis, p);
  const Vector3 across{axis[1] * p[2] - axis[2] * p[1], axis[2] * p[0] - axis[0] * p[2],
                       axis[0] * p[1] - axis[1] * p[0]};
  Vector3 turned{};
  for (int k = 0; k < 3; ++k) turned[k] = c * p[k] + s * across[k] + (1.0 - c) * along * axis[k];
  return turned;
}

TEST_P(Lit, TurningEverythingChangesNothing) {
  const auto field = [](const Vector3& p) { return std::sin(2.0 * p[0]) * std::cos(1.5 * p[1]) + 0.4 * p[2] * p[2]; };
  const auto body_of = [&](bool is_turned) {
    if (is_grid()) {
      tests::GridOptions options;
      options.dimensions = {15, 14, 13};
      tests::GridOptions turned = options;
      for (int column = 0; column < 3; ++column) {
        Vector3 unit{};
        unit[column] = 1.0;
        const Vector3 image = turn(unit);
        for (int row = 0; row < 3; ++row) turned.direction[3 * row + column] = image[row];
      }
      GridData grid = tests::make_grid(options, field);
      if (is_turned) grid.shape = tests::make_grid(turned, field).shape;
      return tests::Body(grid);
    }
    tests::BoxOptions options;
    options.bricks = {12, 11, 10};
    MeshData mesh = tests::make_box(options, field);
    if (!is_turned) return tests::Body(mesh);
    auto points = std::make_shared<std::vector<double>>(mesh.points.begin(), mesh.points.end());
    for (std::size_t i = 0; i < points->size(); i += 3) {
      const Vector3 p = turn({(*points)[i], (*points)[i + 1], (*points)[i + 2]});
      std::copy(p.begin(), p.end(), points->begin() + static_cast<std::ptrdiff_t>(i));
    }
    mesh.points = *points;
    return tests::Body(mesh);
  };
  const OpticalFunction function{{{-1.0, 0.2, {0.1, 0.2, 0.9}}, {1.4, 2.7, {0.9, 0.7, 0.2}}}};
  RenderSettings settings = make_settings(1e-6);
  settings.lighting = make_lights();
  settings.lighting.gradient_threshold = 0.0;
  settings.surfaces = {{0.3, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.5, true}};
  RenderSettings turned = settings;
  for (Light& light : turned.lighting.lights) {
    light.direction = turn(light.direction);
    light.position = turn(light.position);
  }
  for (const auto& [name, camera] : standard_cameras()) {
    Camera moved = camera;
    moved.position = turn(camera.position);
    moved.focal_point = turn(camera.focal_point);
    moved.view_up = turn(camera.view_up);
    EXPECT_TRUE(tests::images_agree(body_of(true).draw(function, moved, turned),
                                    body_of(false).draw(function, camera, settings), 2e-4))
        << name;
  }
}

TEST_P(Lit, TheSameBytesWithEveryInstructionSetAndAnyThreads) {
  const tests::Body body = cube(14, waves());
  RenderSettings settings;
  settings.width = 97;
  settings.height = 71;
  settings.lighting = make_lights();
  settings.lighting.shadows = ShadowKind::kVolume;
  settings.lighting.shadow_resolution = 32;
  settings.lighting.ambient_occlusion = 4;
  settings.surfaces = {{0.4, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.5, true}, {0.6, {1, 1, 1}, {1, 1, 0}, 0.7, false}};
  settings.clipping.shapes = {{ClipSphere{{0.1, 0.2, 0}, 1.1}, true}, {ClipPlane{{0.2, 0, 0}, {-1, 0.3, 2}}, true}};
  settings.wants_depth = true;
  for (const auto& [name, camera] : standard_cameras()) {
    settings.instruction_set.clear();
    settings.threads = 1;
    const Image image = body.draw(smooth_function(), camera, settings);
    EXPECT_GT(tests::count_covered(image), 500u) << name;
    const auto expect_same = [&](const std::string& what) {
      const Image other = body.draw(smooth_function(), camera, settings);
      EXPECT_TRUE(tests::images_equal(other, image)) << name << " " << what;
      EXPECT_EQ(other.depth, image.depth) << name << " " << what;
    };
    for (const int threads : {2, 5}) {
      settings.threads = threads;
      expect_same(std::to_string(threads) + " threads");
    }
    for (const std::string& set : instruction_sets()) {
      settings.instruction_set = set;
      expect_same(set);
    }
  }
}

TEST_P(Lit, WhatDoesNotGoTogetherIsAnError) {
  const tests::Body body = cube(4, linear_field);
  const Camera camera = standard_cameras()[0].second;
  const auto expect_error = [&](const RenderSettings& settings, const char* what) {
    EXPECT_THROW(body.draw(kHomogeneous, camera, settings), Error) << what;
  };
  const auto lit = [] {
    RenderSettings settings;
    settings.width = settings.height = 9;
    settings.lighting.lights = {{}};
    return settings;
  };
  const auto others = is_grid() ? std::array{GradientMethod::kVertex, GradientMethod::kCell}
                                : std::array{GradientMethod::kFilter, GradientMethod::kCentral};
  for (const GradientMethod method : others) {
    RenderSettings settings = lit();
    settings.lighting.gradient = method;
    expect_error(settings, "gradient of the other kind");
  }
  RenderSettings pre = lit();
  pre.integrator = Integrator::kPre;
  expect_error(pre, "pre-classification");
  RenderSettings shininess = lit();
  shininess.lighting.material.shininess = 0.5;
  expect_error(shininess, "shininess");
  RenderSettings light = lit();
  light.lighting.lights[0] = directional({0, 0, 0});
  expect_error(light, "direction of a light");
  RenderSettings resolution = lit();
  resolution.lighting.shadows = ShadowKind::kVolume;
  resolution.lighting.shadow_resolution = 4;
  expect_error(resolution, "resolution of shadows");
  RenderSettings scale = lit();
  scale.opacity_weight = OpacityWeight::kGradient;
  scale.opacity_weight_scale = 0.0;
  expect_error(scale, "scale of the weight");
  RenderSettings opacity = lit();
  opacity.surfaces = {{0.5, {}, {}, 1.5, true}};
  expect_error(opacity, "opacity of a surface");
  RenderSettings normal = lit();
  normal.clipping.shapes = {{ClipPlane{{0, 0, 0}, {0, 0, 0}}, true}};
  expect_error(normal, "normal of a clip plane");
}

INSTANTIATE_TEST_SUITE_P(All, Lit, ::testing::Bool(), kNameOfBody);

}  // namespace
}  // namespace tetravox::analytic
