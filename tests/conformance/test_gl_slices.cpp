/// Slices draw the pictures of the CPU, the better the more they are: grids.

#include "tests/common/gl.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/conformance/slices.h"
#include "tetravox/error.h"
#include "tetravox/slicing.h"

#include <atomic>
#include <cmath>
#include <map>

namespace tetravox::conformance {
namespace {

constexpr SlicingKind kKinds[] = {SlicingKind::kObject2d, SlicingKind::kObject2dInterpolated, SlicingKind::kStripes2d,
                                  SlicingKind::kView3d, SlicingKind::kShells};

GridData grid_named(const std::string& name) {
  for (const NamedGrid& grid : make_hard_grids())
    if (grid.name == name) return grid.grid;
  throw Error(ErrorCode::kInternal, "there is no grid " + name);
}

/// What a ray passes of each slab is exact, whole or not: in a homogeneous medium any number of slices is.
TEST(GlSlices, HaveNoSeamsAtTheBorder) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("sheared"));
  OpticalFunction fog;
  const double extinction = 1.5 / tests::diagonal_of(scene.grid.bounds);
  fog.points = {{scene.grid.scalar_range.min - 1, extinction, {0.9, 0.5, 0.2}},
                {scene.grid.scalar_range.max + 1, extinction, {0.9, 0.5, 0.2}}};
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(fog);
  cpu.set_transfer_function(fog);
  for (const auto& [name, camera] : scene.cameras) {
    const Image expected = cpu.render(camera, cpu_settings(slices_of(SlicingKind::kView3d, 0)));
    for (const SlicingKind kind : kKinds)
      for (const int slices : {1, 3, 50})
        for (const Integrator integrator : tests::kGridIntegrators)
          EXPECT_TRUE(tests::images_agree(gl.render(camera, slices_of(kind, slices, integrator)), expected, 2e-5))
              << name << " " << name_of(kind) << " " << slices << " " << name_of(integrator);
  }
}

class GlSlicesOf : public ::testing::TestWithParam<std::string> {};

/// Eight times the slices leave less than a fifth of the error where the field is continuous, a third where it is not.
TEST_P(GlSlicesOf, ConvergeToThePictureOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named(GetParam()));
  const bool is_smooth = GetParam() != "cell_data" && GetParam() != "holes";
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  for (const auto& [name, camera] : scene.cameras) {
    const Image expected = cpu.render(camera, cpu_settings(slices_of(SlicingKind::kView3d, 0)));
    for (const SlicingKind kind : kKinds) {
      if (kind == SlicingKind::kObject2d) continue;  // as many as there are textures
      std::map<int, double> rms;
      for (const int slices : {25, 200}) {
        const Image image = gl.render(camera, slices_of(kind, slices));
        EXPECT_TRUE(tests::is_valid_picture(image));
        rms[slices] = tests::compare_images(image, expected).rms;
      }
      const std::string where = name + " " + name_of(kind);
      // Two pictures within their tolerances may be that far apart.
      constexpr double kAlike = 2e-4;
      EXPECT_LE(rms[200], std::max((is_smooth ? 0.2 : 0.3) * rms[25], kAlike)) << where;
      EXPECT_LE(rms[200], is_smooth ? 5e-3 : 3e-2) << where;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Grids, GlSlicesOf,
                         ::testing::Values("smooth", "marschner_lobb", "bytes", "sheared", "cell_data", "holes",
                                           "noise"),
                         [](const auto& test) { return test.param; });

/// Stacks of textures are drawn texture by texture: as fine as the same number of slices between textures.
TEST(GlSlices, AStackIsDrawnTextureByTexture) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("bytes"));
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  for (const auto& [name, camera] : scene.cameras) {
    RenderStatistics drawn;
    const Image image = gl.render(camera, slices_of(SlicingKind::kObject2d, 999), &drawn);
    const auto& dimensions = scene.grid.data.shape.dimensions;
    EXPECT_TRUE(
        std::ranges::any_of(dimensions, [&](auto points) { return drawn.slices == static_cast<int>(points) - 1; }));
    const Image expected = cpu.render(camera, cpu_settings(slices_of(SlicingKind::kView3d, 0)));
    EXPECT_LE(tests::compare_images(image, expected).rms, 3e-2) << name;
  }
}

/// Tables of ray integrals reach as far as the longest way through a slab.
TEST(GlSlices, TablesReachThroughThickSlabs) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("bytes"));
  Renderer gl = make_gl_renderer(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  for (const auto& [name, camera] : scene.cameras)
    for (const SlicingKind kind : kKinds) {
      RenderSettings settings = slices_of(kind, 6, Integrator::kPartial);
      settings.slicing.slabs = SlabShape::kLinear;
      const Image expected = gl.render(camera, settings);
      for (const Integrator integrator : {Integrator::kTable3d, Integrator::kPolynomial}) {
        settings.integrator = integrator;
        settings.preintegration.degree = 4;
        EXPECT_TRUE(tests::images_agree(gl.render(camera, settings), expected, 1e-2, 2e-3))
            << name << " " << name_of(kind) << " " << name_of(integrator);
      }
    }
}

/// The value nearest to a place, whichever of the two textures around it holds that.
TEST(GlSlices, StripesTakeTheNearestValue) {
  TETRAVOX_REQUIRE_GL();
  for (const char* name : {"bytes", "cell_data"}) {
    const GridSubject scene(grid_named(name));
    Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
    gl.set_transfer_function(scene.function("smooth"));
    cpu.set_transfer_function(scene.function("smooth"));
    RenderSettings settings = slices_of(SlicingKind::kStripes2d, 800);
    settings.filter = {FilterKind::kNearest};
    const Camera& camera = scene.camera("outside");
    EXPECT_LE(tests::compare_images(gl.render(camera, settings), cpu.render(camera, cpu_settings(settings))).rms, 5e-3)
        << name;
  }
}

/// What a frame has switched on is off again, however it ends.
TEST(GlSlices, AFrameThatWasCancelledLeavesNothingBehind) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("bytes"));
  Renderer renderer = make_gl_renderer(scene.grid), fresh = make_gl_renderer(scene.grid);
  renderer.set_transfer_function(scene.function("smooth"));
  fresh.set_transfer_function(scene.function("smooth"));
  const Camera& camera = scene.camera("outside");
  const std::atomic<bool> cancelled{true};
  for (const FilterKind filter : {FilterKind::kLinear, FilterKind::kBspline}) {
    RenderSettings stopped = slices_of(SlicingKind::kView3d, 100);
    stopped.filter = {filter};
    EXPECT_THROW(renderer.render(camera, stopped, nullptr, {.report = {}, .cancelled = &cancelled}), Error);
    RenderSettings settings = tests::make_settings(Integrator::kPolynomial, 48, 36);
    settings.preintegration.device = TableDevice::kGpu;
    settings.preintegration.scalars = 64;
    EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings), fresh.render(camera, settings)));
  }
}

TEST(GlSlices, EveryClassificationConverges) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("smooth"));
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  const Camera& camera = scene.camera("outside");
  for (const SlicingKind kind : kKinds) {
    if (kind == SlicingKind::kObject2d) continue;
    for (const Integrator integrator : tests::kGridIntegrators) {
      const RenderSettings settings = slices_of(kind, 400, integrator);
      RenderSettings same = cpu_settings(settings);
      if (integrator == Integrator::kPost) same.integrator = Integrator::kAntiderivative;
      EXPECT_TRUE(tests::images_agree(gl.render(camera, settings), cpu.render(camera, same), 1e-2, 1e-3))
          << name_of(kind) << " " << name_of(integrator);
    }
  }
}

/// Slab by slab, pre-integration needs a quarter of the slices on functions that are hard to draw.
TEST(GlSlices, PreintegratedNeedAQuarterOfThoseOfPostClassification) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("smooth"));
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  for (const char* function : {"spikes", "steps", "random"})
    for (const char* camera : {"outside", "orthographic"}) {
      gl.set_transfer_function(scene.function(function));
      cpu.set_transfer_function(scene.function(function));
      const Image expected = cpu.render(scene.camera(camera), cpu_settings(slices_of(SlicingKind::kView3d, 0)));
      const auto rms = [&](int slices, Integrator integrator) {
        return tests::compare_images(
                   gl.render(scene.camera(camera), slices_of(SlicingKind::kView3d, slices, integrator)), expected)
            .rms;
      };
      for (const int slices : {40, 80, 160})
        EXPECT_LE(rms(slices, Integrator::kAntiderivative), rms(4 * slices, Integrator::kPost))
            << function << " " << camera << " " << slices;
    }
}

TEST(GlSlices, KnowAllNumberTypes) {
  TETRAVOX_REQUIRE_GL();
  for (const ScalarType type : tests::kAllScalarTypes) {
    tests::GridOptions options;
    options.type = type;
    const GridSubject scene(
        make_grid(options, [](const Vector3& p) { return 50.0 + 40.0 * std::sin(2 * p[0] + p[1]); }));
    Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
    gl.set_transfer_function(scene.function("smooth"));
    cpu.set_transfer_function(scene.function("smooth"));
    for (const SlicingKind kind : {SlicingKind::kView3d, SlicingKind::kStripes2d}) {
      const RenderSettings settings = slices_of(kind, 300);
      EXPECT_TRUE(tests::images_agree(gl.render(scene.camera("outside"), settings),
                                      cpu.render(scene.camera("outside"), cpu_settings(settings)), 5e-3, 5e-4))
          << static_cast<int>(type) << " " << name_of(kind);
    }
  }
}

/// Each tile of a kernel times the values it falls on, added up: the field as the CPU filters it.
TEST(GlSlices, FiltersAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  for (const char* name : {"bytes", "cell_data"}) {
    const GridSubject scene(grid_named(name));
    Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
    gl.set_transfer_function(scene.function("smooth"));
    cpu.set_transfer_function(scene.function("smooth"));
    for (const Filter& filter : all_filters())
      for (const SlicingKind kind : {SlicingKind::kView3d, SlicingKind::kShells}) {
        RenderSettings settings = slices_of(kind, filter.kind == FilterKind::kNearest ? 800 : 200);
        settings.filter = filter;
        const Image image = gl.render(scene.camera("outside"), settings);
        const Image expected = cpu.render(scene.camera("outside"), cpu_settings(settings));
        EXPECT_LE(tests::compare_images(image, expected).rms, 3e-3)
            << name << " " << name_of(filter) << " " << name_of(kind);
      }
  }
}

TEST(GlSlices, FramesDoNotDependOnThoseBefore) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("smooth"));
  Renderer gl = make_gl_renderer(scene.grid);
  gl.set_transfer_function(scene.function("random"));
  const RenderSettings small = slices_of(SlicingKind::kStripes2d, 30);
  RenderSettings marched = small;
  marched.source = Source::kMarch;
  const Image first = gl.render(scene.camera("outside"), small),
              first_marched = gl.render(scene.camera("outside"), marched);
  gl.set_transfer_function(scene.function("thick"));
  RenderSettings large = slices_of(SlicingKind::kView3d, 60);
  large.width = 90;
  large.filter.kind = FilterKind::kBspline;
  gl.render(scene.camera("inside"), large);
  large.source = Source::kMarch;
  gl.render(scene.camera("inside"), large);
  gl.set_transfer_function(scene.function("random"));
  EXPECT_TRUE(tests::images_equal(gl.render(scene.camera("outside"), small), first));
  EXPECT_TRUE(tests::images_equal(gl.render(scene.camera("outside"), marched), first_marched));
}

TEST(GlSlices, StatisticsSayWhatWasDrawn) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("smooth"));
  RenderStatistics drawn, expected;
  Renderer gl = make_gl_renderer(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  const RenderSettings settings = slices_of(SlicingKind::kView3d, 64);
  gl.render(scene.camera("outside"), settings, &drawn);
  EXPECT_GT(drawn.slices, 40);
  EXPECT_LE(drawn.slices, 66);
  EXPECT_GT(drawn.rays, 100u);
  EXPECT_GT(drawn.segments, 10 * drawn.rays);
  EXPECT_EQ(drawn.backend, "gl");
  EXPECT_EQ(drawn.integrator, "antiderivative");
}

TEST(GlSlices, WhatTheyCannotDrawTheyRefuseByName) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("smooth")), uneven(grid_named("uneven"));
  Renderer gl = make_gl_renderer(scene.grid), on_uneven = make_gl_renderer(uneven.grid), cpu(scene.grid);
  for (Renderer* renderer : {&gl, &on_uneven, &cpu}) renderer->set_transfer_function(scene.function("smooth"));
  const auto expect_refusal = [&](const char* name, Renderer& renderer, const RenderSettings& settings) {
    try {
      renderer.render(scene.camera("outside"), settings);
      ADD_FAILURE() << name << " was not refused";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  };
  const RenderSettings plain = slices_of(SlicingKind::kView3d, 20);
  expect_refusal("uneven", on_uneven, plain);
  expect_refusal("'slices' does not draw grids", cpu, plain);
  RenderSettings settings = plain;
  settings.clipping.shapes.push_back({ClipPlane{}});
  expect_refusal("clipping", gl, settings);
  settings = plain;
  settings.opacity_weight = OpacityWeight::kGradient;
  expect_refusal("opacity weights", gl, settings);
  settings = plain;
  settings.wants_depth = true;
  expect_refusal("depths", gl, settings);
  settings = plain;
  settings.lighting.lights.push_back({.kind = LightKind::kPoint});
  expect_refusal("point lights", gl, settings);
  settings = plain;
  settings.filter = {FilterKind::kLanczos, 5};
  expect_refusal("lanczos=5", gl, settings);
  settings = plain;
  settings.slicing.slices = -1;
  expect_refusal("slices", gl, settings);
  settings = plain;
  settings.source.reset();
  settings.lighting.lights.emplace_back();
  settings.lighting.shadows = ShadowKind::kHalfAngle;
  expect_refusal("half-angle", cpu, settings);
}

}  // namespace
}  // namespace tetravox::conformance
