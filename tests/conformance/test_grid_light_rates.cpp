/// Light on grids at a fixed rate: against light in as many places as the tolerance asks for.

#include "src/scene/fixed_rate.h"
#include "tests/common/direction_lookup.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/grid_rates.h"
#include "tests/conformance/grid_scenes.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::conformance {
namespace {

RenderSettings lit_at_rate(double rate, Integrator integrator, double tolerance = 2e-3) {
  RenderSettings settings = at_rate(rate, integrator, tolerance);
  settings.lighting.lights = {Light{}};
  return settings;
}

/// The same in as many places as it takes.
RenderSettings without_rate(RenderSettings settings) {
  settings.samples_per_voxel = 0.0;
  settings.integrator = Integrator::kPartial;
  settings.tolerance = 1e-3;
  return settings;
}

/// Gradients of the trilinear field jump from cell to cell: with them convergence is of first order.
TEST(GridLightRates, ConvergeToTheLitPicture) {
  for (const ScalarType type : kInPlace) {
    const GridSubject scene(make_numbers(type));
    for (const auto& [gradient, gain] : {std::pair(GradientMethod::kCentral, 3.0), {GradientMethod::kFilter, 1.5}})
      for (const auto& [name, camera] : scene.cameras)
        for (const char* function : {"smooth", "thick"}) {
          double before = 1.0;
          for (const double rate : {1.0, 4.0, 16.0}) {
            RenderSettings settings = lit_at_rate(rate, Integrator::kAntiderivative);
            settings.lighting.gradient = gradient;
            const tests::ImageDifference difference =
                tests::compare_images(render(scene.grid, scene.function(function), camera, settings),
                                      render(scene.grid, scene.function(function), camera, without_rate(settings)));
            std::printf("%s, %s gradients, %s, %s, %g samples a voxel: max %.2e RMS %.2e\n",
                        scalar_type_name(type).c_str(), name_of(gradient).c_str(), name.c_str(), function, rate,
                        difference.max, difference.rms);
            EXPECT_LT(difference.rms, std::max(before / gain, 1e-3))
                << scalar_type_name(type) << " " << name_of(gradient) << " " << name << " " << function << " " << rate;
            before = difference.rms;
          }
        }
  }
}

Light make_light(LightKind kind, const Vector3& vector, const Color& color) {
  Light light;
  light.kind = kind;
  light.direction = light.position = vector;
  light.color = color;
  return light;
}

/// Every kind of light, shadow and surroundings.
std::vector<std::pair<std::string, Lighting>> make_lightings() {
  Lighting lights;
  lights.lights = {make_light(LightKind::kDirectional, {-1, -2, 1}, {1.0, 0.7, 0.4}),
                   make_light(LightKind::kPoint, {3, -2, 2}, {0.2, 0.4, 0.9})};
  Lighting one_sided = lights;
  one_sided.is_two_sided = false;
  Lighting shadowed = lights;
  shadowed.shadows = ShadowKind::kVolume;
  shadowed.shadow_resolution = 48;
  Lighting traced = lights;
  traced.shadows = ShadowKind::kExact;
  Lighting open = lights;
  open.ambient_occlusion = 16;
  open.shadow_resolution = 32;
  Lighting full = lights;
  full.gradient_threshold = 0.0;
  return {{"lights", lights},        {"one-sided", one_sided}, {"volume shadows", shadowed},
          {"exact shadows", traced}, {"occlusion", open},      {"full strength", full}};
}

TEST(GridLightRates, KnowEveryKindOfLight) {
  const GridSubject scene(make_numbers(ScalarType::kUint8));
  for (const auto& [name, lighting] : make_lightings())
    for (const char* camera_name : {"outside", "inside"}) {
      const Camera& camera = scene.camera(camera_name);
      RenderSettings settings = lit_at_rate(12.0, Integrator::kAntiderivative);
      settings.lighting = lighting;
      const tests::ImageDifference difference =
          tests::compare_images(render(scene.grid, scene.function("smooth"), camera, settings),
                                render(scene.grid, scene.function("smooth"), camera, without_rate(settings)));
      std::printf("%s, %s: max %.2e RMS %.2e\n", name.c_str(), camera_name, difference.max, difference.rms);
      EXPECT_LT(difference.max, 1e-2) << name << " " << camera_name;
      EXPECT_LT(difference.rms, 1e-3) << name << " " << camera_name;
    }
}

TEST(GridLightRates, KnowTheSurroundings) {
  const GridSubject scene(make_numbers(ScalarType::kUint8));
  const Environment sky = tests::make_environment(EnvironmentLayout::kCube, 32, [](const Vector3& d) {
    return std::array<double, 3>{1.0 + d[0], 1.0 + 0.5 * d[1], 1.0 - d[2]};
  });
  RenderSettings settings = lit_at_rate(12.0, Integrator::kAntiderivative);
  settings.lighting.lights.clear();
  settings.lighting.environment = EnvironmentLight{"sky"};
  const auto draw = [&](const RenderSettings& wanted) {
    Renderer renderer(scene.grid);
    renderer.set_transfer_function(scene.function("smooth"));
    renderer.set_environment(sky);
    return renderer.render(scene.camera("outside"), wanted);
  };
  // A side that looks at the eye can be lit by half of the sky, and the next one, which has turned over, by the other.
  EXPECT_TRUE(tests::images_agree(draw(settings), draw(without_rate(settings)), 5e-2, 1e-3));
}

/// Cells that are first and last along an axis.
TEST(GridLightRates, SmallGridsHaveGradientsAtTheirBorder) {
  for (const std::array<std::uint32_t, 3>& dimensions :
       {std::array<std::uint32_t, 3>{2, 2, 2}, {2, 3, 9}, {9, 3, 2}, {3, 2, 4}})
    for (const ScalarType type : kInPlace) {
      tests::GridOptions options;
      options.dimensions = dimensions;
      options.type = type;
      const tests::Field field = tests::make_random_field(9, 2.0);
      const GridSubject scene(make_grid(options, [&](const Vector3& p) { return std::round(100.0 * field(p)); }));
      for (const GradientMethod gradient : {GradientMethod::kCentral, GradientMethod::kFilter}) {
        RenderSettings settings = lit_at_rate(32.0, Integrator::kAntiderivative);
        settings.lighting.gradient = gradient;
        const auto draw = [&](const RenderSettings& wanted) {
          return render(scene.grid, scene.function("smooth"), scene.camera("outside"), wanted);
        };
        EXPECT_TRUE(tests::images_agree(draw(settings), draw(without_rate(settings)), 2e-2, 2e-3))
            << dimensions[0] << " x " << dimensions[1] << " x " << dimensions[2] << " " << scalar_type_name(type) << " "
            << name_of(gradient);
        settings.samples_per_voxel = 0.8;
        settings.tolerance = 0.1;
        for (const float value : draw(settings).pixels) ASSERT_TRUE(std::isfinite(value));
      }
    }
}

/// Rays that the clipping cuts into several parts.
TEST(GridLightRates, ClippedRaysAreTakenUpAgain) {
  const GridSubject scene(make_numbers(ScalarType::kUint8));
  for (const auto& [name, camera] : scene.cameras) {
    RenderSettings settings = lit_at_rate(24.0, Integrator::kAntiderivative);
    settings.clipping.shapes = {{ClipSphere{{0.1, 0.0, -0.1}, 0.6}, false}, {ClipSphere{{-0.5, 0.5, 0.4}, 0.3}, false}};
    EXPECT_TRUE(tests::images_agree(render(scene.grid, scene.function("smooth"), camera, settings),
                                    render(scene.grid, scene.function("smooth"), camera, without_rate(settings)), 3e-3,
                                    3e-4))
        << name;
  }
}

/// Segments of the same ends, looked up with these rounded or integrated exactly, lit.
TEST(GridLightRates, SlabsErrNoMoreThanTheTolerance) {
  for (const auto& [name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    if (!scene::counts_steps(scene.grid, at_rate(1.0, Integrator::kPartial))) continue;
    for (const auto& [function_name, function] : scene.functions)
      for (const double tolerance : {0.1, 0.02}) {
        const Camera& camera = scene.camera("outside");
        const tests::ImageDifference difference = tests::compare_images(
            render(scene.grid, function, camera, lit_at_rate(0.8, Integrator::kAntiderivative, tolerance)),
            render(scene.grid, function, camera, lit_at_rate(0.8, Integrator::kPartial, tolerance)));
        std::printf("%s %s, tolerance %g: max %.2e RMS %.2e\n", name, function_name.c_str(), tolerance, difference.max,
                    difference.rms);
        EXPECT_LE(difference.max, tolerance) << name << " " << function_name;
        EXPECT_LE(difference.rms, tolerance / 10.0) << name << " " << function_name;
      }
  }
}

/// Slabs looked up or integrated, whole rays and clipped ones, light of the eye and any other.
TEST(GridLightRates, InstructionSetsGiveTheSameBytes) {
  for (const ScalarType type : kInPlace) {
    const GridSubject scene(make_numbers(type));
    for (const GradientMethod gradient : {GradientMethod::kCentral, GradientMethod::kFilter})
      for (const double tolerance : {0.1, 2e-3})
        for (const bool is_simple : {true, false}) {
          RenderSettings settings = lit_at_rate(0.8, Integrator::kAntiderivative, tolerance);
          if (!is_simple) {
            settings.lighting = make_lightings()[1].second;
            settings.clipping.shapes.push_back({ClipSphere{{0.1, 0.0, -0.1}, 0.6}, false});
          }
          settings.lighting.gradient = gradient;
          const Image first = render(scene.grid, scene.function("smooth"), scene.camera("outside"), settings);
          for (const std::string& instruction_set : instruction_sets()) {
            settings.instruction_set = instruction_set;
            EXPECT_TRUE(tests::images_equal(
                render(scene.grid, scene.function("smooth"), scene.camera("outside"), settings), first))
                << scalar_type_name(type) << " " << name_of(gradient) << " " << tolerance << " " << instruction_set;
          }
        }
  }
}

/// Where each place is lit as brightly as what is too faint for a normal, light is one factor.
TEST(GridLightRates, AmbientLightDarkensEvenly) {
  const GridSubject scene(make_numbers(ScalarType::kInt16));
  for (const auto& [name, camera] : scene.cameras) {
    RenderSettings settings = lit_at_rate(2.0, Integrator::kAntiderivative, 1e-3);
    settings.lighting.material = {0.5, 0.0, 0.0, 1.0};
    const Image lit = render(scene.grid, scene.function("thick"), camera, settings);
    settings.lighting.lights.clear();
    Image expected = render(scene.grid, scene.function("thick"), camera, settings);
    for (std::size_t i = 0; i < expected.pixels.size(); ++i)
      if (i % 4 != 3) expected.pixels[i] *= 0.5f;
    EXPECT_TRUE(tests::images_agree(lit, expected, 1e-3, 2e-4)) << name;
  }
}

/// A light goes out and on again, on one renderer: tables hold what light asks for.
TEST(GridLightRates, LightComesAndGoes) {
  const GridSubject scene(make_numbers(ScalarType::kUint8));
  Renderer renderer(scene.grid);
  renderer.set_transfer_function(scene.function("smooth"));
  const Camera& camera = scene.camera("outside");
  for (const bool is_lit : {false, true, false, true}) {
    RenderSettings settings = lit_at_rate(1.0, Integrator::kAntiderivative, 0.1);
    if (!is_lit) settings.lighting.lights.clear();
    EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings),
                                    render(scene.grid, scene.function("smooth"), camera, settings)))
        << is_lit;
  }
}

TEST(GridLightRates, RefuseWhatFollowsTheCells) {
  const GridSubject numbers(make_numbers(ScalarType::kUint8)), doubles(make_numbers(ScalarType::kFloat64));
  const auto draw = [](const GridSubject& scene, const RenderSettings& settings) {
    return render(scene.grid, scene.function("smooth"), scene.camera("outside"), settings);
  };
  const RenderSettings lit = lit_at_rate(1.0, Integrator::kAntiderivative);
  EXPECT_NO_THROW(draw(numbers, lit));
  EXPECT_THROW(draw(doubles, lit), Error);
  RenderSettings with_surface = lit, with_weight = lit, with_depth = lit, sampled = lit;
  with_surface.surfaces.push_back({});
  with_weight.opacity_weight = OpacityWeight::kGradient;
  with_depth.wants_depth = true;
  sampled.integrator = Integrator::kPost;
  for (const RenderSettings& settings : {with_surface, with_weight, with_depth, sampled})
    EXPECT_THROW(draw(numbers, settings), Error);
}

}  // namespace
}  // namespace tetravox::conformance
