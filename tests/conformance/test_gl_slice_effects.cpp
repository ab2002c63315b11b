/// Light, surfaces and half-angle shadows of slices, beside those of the CPU.

#include "tests/common/gl.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/conformance/slices.h"

#include <cmath>

namespace tetravox::conformance {
namespace {

GridData smooth_grid(ScalarType type = ScalarType::kFloat32) {
  tests::GridOptions options;
  options.dimensions = {22, 19, 17};
  options.type = type;
  const tests::Field field = tests::make_random_field(21, 3.0);
  return make_grid(options, [=](const Vector3& p) { return 200.0 * field(p); });
}

Lighting two_lights() {
  Lighting lighting;
  lighting.lights = {{.color = {1, 0.8, 0.6}},
                     {.kind = LightKind::kDirectional, .direction = {1, 0.3, -0.6}, .intensity = 0.7}};
  return lighting;
}

TEST(GlSliceEffects, LightIsThatOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(smooth_grid(ScalarType::kUint8));
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  for (const char* camera : {"outside", "orthographic", "inside"})
    for (const bool is_two_sided : {true, false})
      for (const SlicingKind kind : {SlicingKind::kView3d, SlicingKind::kStripes2d, SlicingKind::kShells}) {
        RenderSettings settings = slices_of(kind, 400);
        settings.lighting = two_lights();
        settings.lighting.is_two_sided = is_two_sided;
        EXPECT_TRUE(tests::images_agree(gl.render(scene.camera(camera), settings),
                                        cpu.render(scene.camera(camera), cpu_settings(settings)), 2e-2, 1.5e-3))
            << camera << " " << name_of(settings.integrator) << " " << is_two_sided;
      }
}

TEST(GlSliceEffects, LightOfFiltersFollowsTheirDerivative) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(smooth_grid());
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  for (const FilterKind filter : {FilterKind::kBspline, FilterKind::kCatmullRom, FilterKind::kInterpolatingBspline})
    for (const GradientMethod gradient : {GradientMethod::kFilter, GradientMethod::kCentral}) {
      RenderSettings settings = slices_of(SlicingKind::kView3d, 200);
      settings.filter.kind = filter;
      settings.lighting = two_lights();
      settings.lighting.gradient = gradient;
      EXPECT_TRUE(tests::images_agree(gl.render(scene.camera("outside"), settings),
                                      cpu.render(scene.camera("outside"), cpu_settings(settings)), 3e-2, 3e-3))
          << static_cast<int>(filter) << " " << name_of(gradient);
    }
}

/// Surfaces of a ball: where a slab holds both sides of it nothing is seen, so that the outline alone is a matter of
/// the slices' distance.
TEST(GlSliceEffects, SurfacesAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  tests::GridOptions options;
  options.dimensions = {33, 33, 33};
  const GridSubject scene(make_grid(options, [](const Vector3& p) { return 1.0 - std::hypot(p[0], p[1], p[2]); }));
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  for (const char* function : {"smooth", "steps"}) {
    gl.set_transfer_function(scene.function(function));
    cpu.set_transfer_function(scene.function(function));
    for (const char* camera : {"outside", "inside"})
      for (const bool is_two_sided : {true, false}) {
        RenderSettings settings = slices_of(SlicingKind::kView3d, 1000);
        settings.surfaces = {{0.6, {0, 1, 0}, {1, 1, 0}, 0.7, is_two_sided},
                             {0.3, {1, 0, 0}, {0, 0, 1}, 0.5, is_two_sided},
                             {0.45, {1, 1, 1}, {0, 1, 1}, 0.2, true}};
        settings.lighting = two_lights();
        EXPECT_LE(tests::compare_images(gl.render(scene.camera(camera), settings),
                                        cpu.render(scene.camera(camera), cpu_settings(settings)))
                      .rms,
                  1.5e-2)
            << function << " " << camera << " " << is_two_sided;
      }
  }
}

/// A homogeneous cube, lit from one side: light arrives by Beer's law, as the CPU's exact shadows have it.
TEST(HalfAngle, AHomogeneousCubeAgreesWithBeersLaw) {
  TETRAVOX_REQUIRE_GL();
  tests::GridOptions options;
  const GridSubject scene(make_grid(options, [](const Vector3& p) { return p[0]; }));
  OpticalFunction fog;
  fog.points = {{-2.0, 1.2, {0.9, 0.6, 0.2}}, {2.0, 1.2, {0.9, 0.6, 0.2}}};
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(fog);
  cpu.set_transfer_function(fog);
  const Vector3 ways[] = {{1, 0, 0}, {0, 1, 0}, {-0.4, 0.2, -1}, {0.3, -1, 0.5}};
  for (const char* camera : {"outside", "orthographic", "inside"})
    for (const Vector3& way : ways) {
      RenderSettings settings = slices_of(SlicingKind::kView3d, 200);
      settings.lighting.lights = {{.kind = LightKind::kDirectional, .direction = way, .color = {1, 0.9, 0.5}}};
      settings.lighting.material = {0.0, 1.0, 0.0, 1.0};
      settings.lighting.gradient_threshold = 1e6;  // no normals
      settings.lighting.shadows = ShadowKind::kHalfAngle;
      const Image expected = cpu.render(scene.camera(camera), cpu_settings(settings));
      EXPECT_TRUE(tests::images_agree(gl.render(scene.camera(camera), settings), expected, 1e-2, 1e-3))
          << camera << " light " << way[0] << " " << way[1] << " " << way[2];
    }
}

TEST(HalfAngle, ShadowsOfAFieldAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(smooth_grid());
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  RenderSettings settings = slices_of(SlicingKind::kView3d, 400);
  settings.lighting.lights = {{.kind = LightKind::kDirectional, .direction = {1, 1, -1}}};
  settings.lighting.shadows = ShadowKind::kHalfAngle;
  settings.lighting.shadow_resolution = 256;
  for (const char* camera : {"outside", "orthographic"})
    EXPECT_TRUE(tests::images_agree(gl.render(scene.camera(camera), settings),
                                    cpu.render(scene.camera(camera), cpu_settings(settings)), 3e-2, 2e-3))
        << camera;
  // From inside some rays run along the slices, and few of them cut such a ray.
  EXPECT_LE(tests::compare_images(gl.render(scene.camera("inside"), settings),
                                  cpu.render(scene.camera("inside"), cpu_settings(settings)))
                .rms,
            5e-3);
}

/// Scattered light reaches deeper, the more so in the medium's own colour.
TEST(HalfAngle, TranslucencyBrightensInTheColourOfTheMedium) {
  TETRAVOX_REQUIRE_GL();
  tests::GridOptions options;
  const GridSubject scene(make_grid(options, [](const Vector3& p) { return p[0]; }));
  OpticalFunction wax;
  wax.points = {{-2.0, 3.0, {1.0, 0.5, 0.1}}, {2.0, 3.0, {1.0, 0.5, 0.1}}};
  Renderer gl = make_gl_renderer(scene.grid);
  gl.set_transfer_function(wax);
  RenderSettings settings = slices_of(SlicingKind::kView3d, 150);
  settings.lighting.lights = {{.kind = LightKind::kDirectional, .direction = {1, 0, 0}}};
  settings.lighting.shadows = ShadowKind::kHalfAngle;
  const Camera& camera = scene.camera("outside");
  const auto sums = [&](double translucency) {
    settings.lighting.translucency = translucency;
    const Image image = gl.render(camera, settings);
    std::array<double, 4> sum{};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) sum[i % 4] += image.pixels[i];
    return sum;
  };
  const auto opaque = sums(0.0), half = sums(0.5), full = sums(1.0);
  EXPECT_NEAR(full[3], opaque[3], 1e-3 * opaque[3]);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(half[i], opaque[i]);
    EXPECT_GT(full[i], half[i]);
  }
  EXPECT_GT(full[0] / opaque[0], 1.1 * full[1] / opaque[1]);
  EXPECT_GT(full[1] / opaque[1], 1.1 * full[2] / opaque[2]);

  // What is scattered does not depend on the number of slices.
  const Image coarse = gl.render(camera, settings);
  settings.slicing.slices = 600;
  EXPECT_TRUE(tests::images_agree(gl.render(camera, settings), coarse, 3e-2, 5e-3));
}

}  // namespace
}  // namespace tetravox::conformance
