/// Surroundings that light volumes and surfaces: closed forms of simple ones, look-ups of rich ones, what must not
/// change a picture.

#include "tests/analytic/cube.h"
#include "tests/analytic/light_model.h"
#include "tests/analytic/show.h"
#include "tests/common/direction_lookup.h"
#include "tests/common/functions.h"
#include "tests/common/image_compare.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::analytic {
namespace {

const OpticalFunction kNothing{{{0.0, 0.0, {0, 0, 0}}}};
const Material kMaterial{0.1, 0.6, 0.4, 20.0};

/// Light that is 1 + vector . d in a world direction d, channel by channel.
struct LinearLight {
  std::array<Vector3, 3> channels{{{0.5, 0.1, -0.3}, {-0.2, 0.6, 0.2}, {0.1, -0.3, 0.7}}};
};

/// The same in the frame of an environment that lies in the world as `light` says.
Environment make_linear_environment(const LinearLight& wanted, const EnvironmentLight& light) {
  const auto axes = environment_axes(light.up, light.rotation);
  return tests::make_environment(EnvironmentLayout::kCube, 64, [&](const Vector3& d) {
    std::array<double, 3> radiance{};
    for (std::size_t c = 0; c < 3; ++c) {
      radiance[c] = 1.0;
      for (std::size_t axis = 0; axis < 3; ++axis) radiance[c] += d[axis] * dot(wanted.channels[c], axes[axis]);
    }
    return radiance;
  });
}

/// What surroundings add at a place: by unit normal, and by reflected view.
struct Filtered {
  std::function<Color(const Vector3&)> diffuse, specular;
  Color mean{};
};

/// Cosine lobes keep 2/3 of light that is linear in the direction (Ramamoorthi and Hanrahan 2001), cos^N(theta / 2)
/// keeps N / (N + 4): the mean cosine.
Filtered filter_linear(const LinearLight& light, double shininess) {
  const auto kept = [light](double part) {
    return [=](const Vector3& d) {
      Color color{};
      for (std::size_t c = 0; c < 3; ++c) color[c] = 1.0 + part * dot(light.channels[c], d);
      return color;
    };
  };
  return {kept(2.0 / 3.0), kept(shininess / (shininess + 4.0)), {1.0, 1.0, 1.0}};
}

/// `illuminate` with surroundings.
Illumination illuminate_around(const Lighting& lighting, const Filtered& around, const Ray& ray, const Vector3& place,
                               const Vector3& gradient, double strength) {
  Illumination light = illuminate(lighting, ray.direction, place, gradient, strength);
  const Vector3 to_eye = scaled(ray.direction, -1.0);
  Vector3 normal = normalized(scaled(gradient, -1.0));
  const bool is_turned = dot(normal, to_eye) < 0.0;
  if (is_turned && lighting.is_two_sided) normal = scaled(normal, -1.0);
  const Vector3 mirrored = difference(scaled(normal, 2.0 * dot(normal, to_eye)), to_eye);
  const Color diffuse = around.diffuse(normal), specular = around.specular(mirrored);
  const bool is_mirror = lighting.is_two_sided || !is_turned;
  const double intensity = lighting.environment->intensity;
  for (std::size_t c = 0; c < 3; ++c) {
    light.diffuse[c] +=
        intensity * lighting.material.diffuse * ((1.0 - strength) * around.mean[c] + strength * diffuse[c]);
    if (is_mirror) light.specular[c] += intensity * lighting.material.specular * strength * specular[c];
  }
  return light;
}

Vector3 slope_of(int number) {
  const std::array<Vector3, 4> slopes{
      {{0.2, 0.15, -0.1}, {-0.05, 0.1, 0.25}, {0.22, -0.12, 0.04}, {-0.03, -0.27, -0.08}}};
  return slopes[static_cast<std::size_t>(number)];
}

/// Grids and meshes of [-1, 1]^3.
class Surrounded : public ::testing::TestWithParam<bool> {
 protected:
  static bool is_grid() { return GetParam(); }
  static tests::Body cube(int cells, const tests::Field& field) { return make_cube(is_grid(), cells, field); }
  static tests::Body linear_cube(const Vector3& slope, int cells = 10) {
    return cube(cells, [slope](const Vector3& p) { return 0.5 + dot(slope, p); });
  }
  static RenderSettings make_settings(double tolerance = 1e-5) {
    RenderSettings settings = make_careful_settings(Integrator::kAntiderivative);
    settings.tolerance = tolerance;
    settings.lighting.material = kMaterial;
    settings.lighting.environment = EnvironmentLight{"builtin:white"};
    return settings;
  }
};

Renderer make_renderer(const tests::Body& body, const OpticalFunction& function, const Environment& environment) {
  Renderer renderer = body.make_renderer();
  renderer.set_transfer_function(function);
  renderer.set_environment(environment);
  return renderer;
}

Image draw(const tests::Body& body, const OpticalFunction& function, const Camera& camera,
           const RenderSettings& settings, const Environment& environment) {
  return make_renderer(body, function, environment).render(camera, settings);
}

void expect_surrounded(const tests::Body& body, const OpticalFunction& function, const RenderSettings& settings,
                       const Environment& environment, const std::function<Rgba(const Ray&)>& expected,
                       const Tolerance& tolerance) {
  Renderer renderer = make_renderer(body, function, environment);
  for (const auto& [name, camera] : standard_cameras())
    EXPECT_TRUE(shows(renderer.render(camera, settings), camera, expected, tolerance)) << name;
}

TEST_P(Surrounded, WhiteIsOneEverywhere) {
  // The volume is as it is; a surface has what a light of strength 1 before it gives, and its highlight.
  const Environment white = make_builtin_environment("white");
  const tests::Body body = cube(14, norm);
  Renderer volume = make_renderer(body, kHomogeneous, white), surface = make_renderer(body, kNothing, white);
  RenderSettings settings = make_settings(1e-6);
  for (const double threshold : {0.0, 2.0}) {
    settings.lighting.gradient_threshold = threshold;
    settings.lighting.material = {0.25, 0.75, 0.0, 20.0};
    for (const auto& [name, camera] : standard_cameras()) {
      RenderSettings unlit = settings;
      unlit.lighting = {};
      EXPECT_TRUE(tests::images_agree(volume.render(camera, settings), body.draw(kHomogeneous, camera, unlit), 1e-5))
          << name;
    }
  }
  settings.lighting.material = kMaterial;
  settings.lighting.environment->intensity = 0.5;
  settings.surfaces = {{0.7, {0.7, 0.5, 0.3}, {0.7, 0.5, 0.3}, 1.0, true}};
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = surface.render(camera, settings);
    EXPECT_GT(tests::count_covered(image), 200u) << name;
    for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
      if (image.pixels[i + 3] == 0.0f) continue;
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(image.pixels[i + c], settings.surfaces[0].front_color[c] * (0.1 + 0.5 * 0.6) + 0.5 * 0.4, 2e-5);
    }
  }
}

/// The nearest of opaque sheets in the field 1/2 + slope . p.
Rgba show_sheets(const RenderSettings& settings, const Filtered& around, const Vector3& slope, const Ray& ray) {
  const Chord chord = intersect_box(ray, kLower, kUpper);
  const double rate = dot(slope, ray.direction), at_eye = 0.5 + dot(slope, ray.origin);
  double nearest = chord.far;
  Rgba result{};
  for (const Isosurface& surface : settings.surfaces) {
    const double t = (surface.value - at_eye) / rate;
    if (!(t > chord.near && t < nearest)) continue;
    nearest = t;
    const Color lit = illuminate_around(settings.lighting, around, ray, ray.at(t), slope, 1.0)
                          .apply(rate > 0.0 ? surface.front_color : surface.back_color);
    result = {lit[0], lit[1], lit[2], 1.0};
  }
  return result;
}

TEST_P(Surrounded, SheetsInLinearLightHaveTheirClosedForm) {
  const LinearLight linear;
  for (const bool is_two_sided : {true, false})
    for (const EnvironmentLight& light :
         {EnvironmentLight{"a.exr", 1.0, 0.0, {0, 0, 1}}, EnvironmentLight{"a.exr", 0.7, -130.0, {0.3, 2.0, -1.0}}}) {
      RenderSettings settings = make_settings();
      settings.lighting = make_lights();  // all lights add up
      settings.lighting.environment = light;
      settings.lighting.is_two_sided = is_two_sided;
      for (const double value : {0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7})
        settings.surfaces.push_back({value, {0.9, 0.5, 0.3}, {0.3, 0.6, 0.8}, 1.0, true});
      const Filtered around = filter_linear(linear, settings.lighting.material.shininess);
      const Environment environment = make_linear_environment(linear, light);
      for (int number = 0; number < 4; ++number) {
        const Vector3 slope = slope_of(number);
        expect_surrounded(linear_cube(slope, 7), kNothing, settings, environment,
                          [&](const Ray& ray) { return show_sheets(settings, around, slope, ray); }, {3e-3, 1e-5});
      }
    }
}

TEST_P(Surrounded, VolumeInLinearLightHasItsClosedForm) {
  const LinearLight linear;
  const Vector3 slope = slope_of(0);
  const tests::Body body = linear_cube(slope);
  const double range = body.scalar_range().max - body.scalar_range().min;
  for (const double threshold : {0.0, 2.0}) {
    RenderSettings settings = make_settings();
    settings.lighting.gradient_threshold = threshold;
    const double half = threshold * range / tests::diagonal_of(body.bounds()), g = norm(slope);
    const double strength = g * g / (g * g + half * half);
    const Filtered around = filter_linear(linear, kMaterial.shininess);
    expect_surrounded(body, kHomogeneous, settings, make_linear_environment(linear, *settings.lighting.environment),
                      [&](const Ray& ray) {
                        // The light is the same all along the ray.
                        const Color lit =
                            illuminate_around(settings.lighting, around, ray, {}, slope, strength).apply(kColor);
                        return fill(lit, kExtinction * intersect_box(ray, kLower, kUpper).length());
                      },
                      {3e-3, 1e-5});
  }
}

TEST_P(Surrounded, EveryDirectionIsLookedUpAsTheMapSays) {
  // Mirrors of many directions in a rich environment: all faces of the map, its edges, its poles.
  const Environment room = make_builtin_environment("room");
  RenderSettings settings = make_settings();
  settings.lighting.environment->rotation = 25.0;
  const auto axes = environment_axes({0, 0, 1}, 25.0);
  const optics::FilteredEnvironment filtered = optics::filter_environment(room, kMaterial.shininess);
  const auto find = [&](const optics::DirectionTable& table) {
    return [&](const Vector3& d) { return tests::look_up(table, {dot(d, axes[0]), dot(d, axes[1]), dot(d, axes[2])}); };
  };
  const Filtered around{
      find(filtered.diffuse), find(filtered.specular), {filtered.mean[0], filtered.mean[1], filtered.mean[2]}};
  for (const Vector3& slope : {Vector3{0.3, 0, 0}, Vector3{0, -0.3, 0}, Vector3{0, 0, 0.3}, Vector3{0.1, 0.1, 0.1},
                               Vector3{-0.1, 0.1, 0.0}, slope_of(2), slope_of(3)}) {
    const tests::Body sheet = linear_cube(slope, 4);
    expect_surrounded(
        sheet, kHomogeneous, settings, room,
        [&](const Ray& ray) {
          const double half = settings.lighting.gradient_threshold *
                              (sheet.scalar_range().max - sheet.scalar_range().min) /
                              tests::diagonal_of(sheet.bounds());
          const double g = norm(slope);
          const Color lit =
              illuminate_around(settings.lighting, around, ray, {}, slope, g * g / (g * g + half * half)).apply(kColor);
          return fill(lit, kExtinction * intersect_box(ray, kLower, kUpper).length());
        },
        {1e-4, 1e-5});
  }
}

TEST_P(Surrounded, LitSphereApproachesItsClosedForm) {
  const LinearLight linear;
  RenderSettings settings = make_settings();
  settings.surfaces = {{0.7, {0.7, 0.5, 0.3}, {0.3, 0.6, 0.8}, 1.0, true}};
  const Environment environment = make_linear_environment(linear, *settings.lighting.environment);
  const Filtered around = filter_linear(linear, kMaterial.shininess);
  const auto error_of = [&](int cells, const Camera& camera) {
    const Image image = draw(cube(cells, norm), kNothing, camera, settings, environment);
    double worst = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Ray ray = make_ray(camera, image.width, image.height, x, y);
        const double nearest = -dot(ray.origin, ray.direction);
        const double square = dot(ray.origin, ray.origin) - nearest * nearest;
        if (square > 0.66 * 0.66) continue;
        const double half = std::sqrt(0.49 - square), t = nearest > half ? nearest - half : nearest + half;
        if (t < 0.0) continue;
        const Color& color =
            norm(camera.position) < 0.7 ? settings.surfaces[0].front_color : settings.surfaces[0].back_color;
        const Color wanted = illuminate_around(settings.lighting, around, ray, ray.at(t), ray.at(t), 1.0).apply(color);
        for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(image.pixel(x, y)[c] - wanted[c]));
      }
    return worst;
  };
  for (const auto& [name, camera] : standard_cameras()) {
    const double coarse = error_of(10, camera), fine = error_of(is_grid() ? 48 : 36, camera);
    EXPECT_LT(fine, 0.02) << name;
    EXPECT_LT(fine, 0.5 * coarse) << name;
  }
}

/// A quarter turn about z.
Vector3 turn(const Vector3& p) { return {-p[1], p[0], p[2]}; }

TEST_P(Surrounded, TurningEverythingChangesNothing) {
  const Environment room = make_builtin_environment("room");
  const Vector3 slope = slope_of(0);
  RenderSettings settings = make_settings();
  settings.surfaces = {{0.45, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.5, true}};
  RenderSettings turned = settings;
  turned.lighting.environment->rotation = 90.0;
  const tests::Body body = linear_cube(slope), turned_body = linear_cube(turn(slope));
  Renderer still = make_renderer(body, kHomogeneous, room), moving = make_renderer(turned_body, kHomogeneous, room);
  for (const auto& [name, camera] : standard_cameras()) {
    Camera moved = camera;
    moved.position = turn(camera.position);
    moved.focal_point = turn(camera.focal_point);
    moved.view_up = turn(camera.view_up);
    const Image image = still.render(camera, settings);
    EXPECT_TRUE(tests::images_agree(moving.render(moved, turned), image, 2e-4)) << name;
    EXPECT_FALSE(tests::images_agree(moving.render(moved, settings), image, 0.02)) << name;
  }
}

TEST_P(Surrounded, OcclusionDarkensItsDiffuseLight) {
  const Environment white = make_builtin_environment("white");
  const tests::Body body = cube(14, norm);
  RenderSettings settings = make_settings(1e-4);
  settings.lighting.ambient_occlusion = 8;
  settings.lighting.shadow_resolution = 16;
  settings.surfaces = {{0.7, {0.7, 0.5, 0.3}, {0.3, 0.6, 0.8}, 0.8, true}};
  // Light of 1 from everywhere is what ambient light is.
  settings.lighting.material = {0.0, 0.7, 0.0, 20.0};
  RenderSettings ambient = settings;
  ambient.lighting.environment.reset();
  ambient.lighting.lights = {{LightKind::kHeadlight, {}, {}, {0, 0, 0}, 0.0}};
  ambient.lighting.material = {0.7, 0.0, 0.0, 20.0};
  RenderSettings open = settings;
  open.lighting.ambient_occlusion = 0;
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = draw(body, kHomogeneous, camera, settings, white);
    EXPECT_TRUE(tests::images_agree(image, body.draw(kHomogeneous, camera, ambient), 2e-5)) << name;
    EXPECT_FALSE(tests::images_agree(image, draw(body, kHomogeneous, camera, open, white), 0.05)) << name;
  }
}

TEST_P(Surrounded, WhatItDependsOnIsSeenAgain) {
  const tests::Body body = linear_cube(slope_of(1), 6);
  const Environment room = make_builtin_environment("room"), sky = make_builtin_environment("sky");
  const Camera camera = standard_cameras()[0].second;
  Renderer kept = body.make_renderer();
  kept.set_transfer_function(kHomogeneous);
  RenderSettings settings = make_settings(1e-3);
  EXPECT_THROW(kept.render(camera, settings), Error);  // no environment yet
  const std::uint64_t bytes = kept.bytes();
  const auto expect_fresh = [&](const Environment& environment, const char* what) {
    EXPECT_TRUE(
        tests::images_equal(kept.render(camera, settings), draw(body, kHomogeneous, camera, settings, environment)))
        << what;
  };
  kept.set_environment(room);
  expect_fresh(room, "first");
  EXPECT_GT(kept.bytes(), bytes + 100000);
  settings.lighting.material.shininess = 90.0;
  expect_fresh(room, "shininess");
  settings.lighting.environment->rotation = 50.0;
  expect_fresh(room, "rotation");
  settings.lighting.environment->up = {1, 0, 0};
  expect_fresh(room, "up");
  settings.lighting.environment->intensity = 1.5;
  expect_fresh(room, "intensity");
  kept.set_environment(sky);
  expect_fresh(sky, "another");
  Environment bad = room;
  bad.width = 7;
  EXPECT_THROW(kept.set_environment(bad), Error);
  expect_fresh(sky, "after one that is refused");
  settings.lighting.environment.reset();
  EXPECT_TRUE(tests::images_equal(kept.render(camera, settings), body.draw(kHomogeneous, camera, settings)));
}

TEST_P(Surrounded, TheSameBytesWithEveryInstructionSetAndAnyThreads) {
  const tests::Body body = cube(14, tests::make_random_field(11, 2.0));
  const OpticalFunction function{
      {{0.2, 0.0, {0.1, 0.2, 0.9}}, {0.5, 3.0, {0.9, 0.7, 0.2}}, {0.9, 0.7, {0.9, 0.1, 0.1}}}};
  const Environment studio = make_builtin_environment("studio");
  RenderSettings settings;
  settings.width = 97;
  settings.height = 71;
  settings.lighting = make_lights();
  settings.lighting.environment = EnvironmentLight{"builtin:studio", 0.8, 40.0, {0.1, 0.2, 1.0}};
  settings.lighting.ambient_occlusion = 4;
  settings.lighting.shadow_resolution = 16;
  settings.surfaces = {{0.4, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.5, true}};
  for (const auto& [name, camera] : standard_cameras()) {
    settings.instruction_set.clear();
    settings.threads = 1;
    const Image image = draw(body, function, camera, settings, studio);
    EXPECT_GT(tests::count_covered(image), 500u) << name;
    settings.threads = 3;
    Renderer renderer = make_renderer(body, function, studio);
    EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings), image)) << name;
    for (const std::string& set : instruction_sets()) {
      settings.instruction_set = set;
      EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings), image)) << name << " " << set;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Surrounded, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "grid" : "mesh"; });

}  // namespace
}  // namespace tetravox::analytic
