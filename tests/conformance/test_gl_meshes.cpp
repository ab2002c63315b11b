/// OpenGL draws the pictures of the CPU: meshes.

#include "tests/common/gl.h"
#include "tests/conformance/scenes.h"
#include "tetravox/error.h"

#include <atomic>

namespace tetravox::conformance {
namespace {

/// How far the pictures of two backends may be apart: rounding, and pieces cut a little differently for it.
constexpr double kMostApart = 5e-4, kMostApartRms = 5e-5;

Subject make_any_subject(const std::string& name) {
  return name == "cell_data" ? make_subject(make_cell_data_mesh()) : make_subject(name);
}

class GlMeshes : public ::testing::TestWithParam<std::string> {};

TEST_P(GlMeshes, PicturesAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_any_subject(GetParam());
  Renderer gl = make_gl_renderer(scene.mesh), cpu(scene.mesh);
  for (const auto& [camera_name, camera] : scene.cameras)
    for (const auto& [function_name, function] : scene.functions) {
      gl.set_transfer_function(function);
      cpu.set_transfer_function(function);
      for (const Integrator integrator : tests::kAllIntegrators)
        for (const EntryOrder order : {EntryOrder::kLists, EntryOrder::kPeeling}) {
          RenderSettings settings = tests::make_settings(integrator, 77, 53);
          settings.entry_order = order;
          RenderStatistics drawn, expected;
          const Image image = gl.render(camera, settings, &drawn);
          const Image same = cpu.render(camera, settings, &expected);
          const std::string where =
              camera_name + " " + function_name + " " + name_of(integrator) + " " + name_of(order);
          EXPECT_TRUE(tests::is_valid_picture(image)) << where;
          EXPECT_TRUE(tests::images_agree(image, same, kMostApart, kMostApartRms)) << where;
          EXPECT_EQ(drawn.rays, expected.rays) << where;
          EXPECT_EQ(drawn.stopped_rays, 0u) << where;
          EXPECT_EQ(drawn.backend, "gl");
          EXPECT_FALSE(drawn.device.empty());
        }
    }
}

/// One formula, two languages: `eval_*` of src/optics, the kernels and the shaders.
TEST_P(GlMeshes, TablesAreLookedUpAsOnTheCpu) {
  TETRAVOX_REQUIRE_GL();
  // Devices may interpolate between texels in steps of 1/256; llvmpipe does not.
  const bool is_exact = gl_devices().front().is_software;
  const Subject scene = make_any_subject(GetParam());
  Renderer gl = make_gl_renderer(scene.mesh), cpu(scene.mesh);
  for (const auto& [camera_name, camera] : scene.cameras)
    for (const auto& [function_name, function] : scene.functions) {
      gl.set_transfer_function(function);
      cpu.set_transfer_function(function);
      for (const Integrator integrator : {Integrator::kTable3d, Integrator::kPolynomial, Integrator::kCylindrical})
        for (const bool is_other : {false, true}) {
          RenderSettings settings = tests::make_settings(integrator, 77, 53);
          settings.use_early_ray_termination = false;
          PreintegrationSettings& tables = settings.preintegration;
          tables.scalars = is_other ? 32 : 24;
          tables.lengths = 16;
          tables.length_spacing = is_other ? LengthSpacing::kUniform : LengthSpacing::kLogarithmic;
          tables.degree = is_other ? 1 : 3;
          tables.opacity = is_other ? OpacityModel::kLinear : OpacityModel::kExponential;
          tables.planes = is_other ? 8 : 9;
          tables.tile = 16;
          tables.steps = 8;
          EXPECT_TRUE(tests::images_agree(gl.render(camera, settings), cpu.render(camera, settings),
                                          is_exact ? 1e-4 : 1e-2, is_exact ? 5e-6 : 1e-3))
              << camera_name << " " << function_name << " " << format_integrator(settings) << " " << is_other;
        }
    }
}

/// The device samples functions where the CPU takes exact means: close where they are smooth, closer with more steps.
TEST_P(GlMeshes, TablesOfTheDeviceDrawThePicturesOfThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_any_subject(GetParam());
  Renderer gl = make_gl_renderer(scene.mesh);
  const Camera& camera = scene.camera("outside");
  for (const char* name : {"smooth", "random"}) {
    const bool is_smooth = name == std::string("smooth");
    gl.set_transfer_function(scene.function(name));
    for (const Integrator integrator : {Integrator::kTable3d, Integrator::kPolynomial, Integrator::kCylindrical}) {
      RenderSettings settings = tests::make_settings(integrator, 77, 53);
      settings.preintegration.scalars = 48;
      settings.preintegration.lengths = 16;
      settings.preintegration.planes = 17;
      settings.preintegration.tile = 32;
      settings.preintegration.steps = is_smooth ? 32 : 256;
      const Image expected = gl.render(camera, settings);
      settings.preintegration.device = TableDevice::kGpu;
      const Image image = gl.render(camera, settings);
      EXPECT_TRUE(tests::is_valid_picture(image)) << name << " " << name_of(integrator);
      EXPECT_TRUE(tests::images_agree(image, expected, 2e-4, 1e-5)) << name << " " << name_of(integrator);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Data, GlMeshes,
                         ::testing::Values("sphere", "buckyball?cells=20000", "duct?cells=4000", "cell_data"),
                         [](const auto& test) { return test.param.substr(0, test.param.find('?')); });

TEST(GlMesh, SegmentsAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject("duct");
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 120, 90);
  settings.use_early_ray_termination = false;
  Renderer gl = make_gl_renderer(scene.mesh);
  gl.set_transfer_function(scene.function("smooth"));
  RenderStatistics drawn, expected;
  gl.render(scene.camera("outside"), settings, &drawn);
  tests::render_with(scene.mesh, scene.function("smooth"), scene.camera("outside"), settings, expected);
  EXPECT_EQ(drawn.segments, expected.segments);
}

TEST(GlMesh, FramesDoNotDependOnThoseBefore) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject("buckyball?cells=20000");
  Renderer gl = make_gl_renderer(scene.mesh);
  gl.set_transfer_function(scene.function("random"));
  RenderSettings small = tests::make_settings(Integrator::kPartial, 40, 30);
  const Image first = gl.render(scene.camera("outside"), small);
  gl.set_transfer_function(scene.function("thick"));
  for (const EntryOrder order : {EntryOrder::kPeeling, EntryOrder::kLists}) {
    RenderSettings large = tests::make_settings(Integrator::kAntiderivative, 150, 110);
    large.entry_order = order;
    gl.render(scene.camera("inside"), large);
    for (const Source source : {Source::kVicp, Source::kProject}) {
      large.source = source;
      large.projection.sort = order == EntryOrder::kLists ? CellSort::kExact : CellSort::kXmpvo;
      gl.render(scene.camera("inside"), large);
    }
  }
  gl.set_transfer_function(scene.function("random"));
  EXPECT_TRUE(tests::images_equal(gl.render(scene.camera("outside"), small), first));
}

/// Rays of a comb of thin plates enter it far more often than lists have room for at first, or are sorted at once.
TEST(GlMesh, RaysMayEnterAnyNumberOfTimes) {
  TETRAVOX_REQUIRE_GL();
  for (const int plates : {60, 1300}) {
    const Subject scene = make_subject(make_comb(plates));
    Renderer gl = make_gl_renderer(scene.mesh), cpu(scene.mesh);
    gl.set_transfer_function(scene.function("smooth"));
    cpu.set_transfer_function(scene.function("smooth"));
    for (const EntryOrder order : {EntryOrder::kLists, EntryOrder::kPeeling}) {
      RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 16, 12);
      settings.entry_order = order;
      RenderStatistics drawn, expected;
      const Image same = cpu.render(kAlongComb, settings, &expected);
      EXPECT_TRUE(tests::images_agree(gl.render(kAlongComb, settings, &drawn), same, 1e-4)) << plates << name_of(order);
      EXPECT_EQ(drawn.segments, expected.segments) << plates << name_of(order);
    }
  }
}

/// Segments of post-classification take as many samples as asked for, in as many passes as that needs.
TEST(GlMesh, SegmentsMayHaveManySamples) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject("buckyball?cells=20000");
  Renderer gl = make_gl_renderer(scene.mesh), cpu(scene.mesh);
  gl.set_transfer_function(scene.function("random"));
  cpu.set_transfer_function(scene.function("random"));
  RenderSettings settings = tests::make_settings(Integrator::kPost, 24, 18);
  settings.samples = 1000;
  EXPECT_TRUE(tests::images_agree(gl.render(scene.camera("outside"), settings),
                                  cpu.render(scene.camera("outside"), settings), kMostApart, kMostApartRms));
}

/// Rays along edges pass cells that have no length for them, and passes may end there: they are not stuck.
TEST(GlMesh, RaysAlongEdgesMayHaveManySamples) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene =
      make_subject(tests::make_box({.bricks = {8, 8, 8}, .lower = {0, 0, 0}, .upper = {8, 8, 8}, .is_hole = {}},
                                   [](const Vector3& p) { return p[2]; }));
  Renderer gl = make_gl_renderer(scene.mesh), cpu(scene.mesh);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  const Camera along{{4, 4, 30}, {4, 4, 0}, {0, 1, 0}, 30.0, 4.25};
  RenderSettings settings = tests::make_settings(Integrator::kPost, 17, 17);
  settings.samples = 4096;
  RenderStatistics drawn;
  EXPECT_TRUE(
      tests::images_agree(gl.render(along, settings, &drawn), cpu.render(along, settings), kMostApart, kMostApartRms));
  EXPECT_EQ(drawn.stopped_rays, 0u);
}

/// What a frame has switched on is off again, however it ends.
TEST(GlMesh, AFrameThatWasCancelledLeavesNothingBehind) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject("buckyball?cells=20000");
  const OpticalFunction& function = scene.function("smooth");
  const std::atomic<bool> cancelled{true};
  for (const Source source : {Source::kWalk, Source::kProject, Source::kVicp}) {
    RenderSettings settings = tests::make_settings(Integrator::kTable3d, 60, 45);
    settings.preintegration.device = TableDevice::kGpu;
    settings.preintegration.scalars = settings.preintegration.lengths = 32;
    Renderer renderer = make_gl_renderer(scene.mesh), fresh = make_gl_renderer(scene.mesh);
    renderer.set_transfer_function(function);
    fresh.set_transfer_function(function);
    for (const Source stopped : {Source::kWalk, Source::kProject, Source::kVicp}) {
      RenderSettings other = tests::make_settings(Integrator::kAntiderivative, 150, 110);
      other.source = stopped;
      other.projection.sort = CellSort::kExact;
      EXPECT_THROW(renderer.render(scene.camera("inside"), other, nullptr, {.report = {}, .cancelled = &cancelled}),
                   Error);
    }
    settings.source = source;
    EXPECT_TRUE(tests::images_equal(renderer.render(scene.camera("outside"), settings),
                                    fresh.render(scene.camera("outside"), settings)))
        << name_of(source);
  }
}

TEST(GlMesh, WhatItCannotDrawItRefusesByName) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject("sphere");
  Renderer gl = make_gl_renderer(scene.mesh);
  gl.set_transfer_function(scene.function("smooth"));
  const auto expect_refusal = [&](const char* name, const RenderSettings& settings) {
    try {
      gl.render(scene.camera("outside"), settings);
      ADD_FAILURE() << name << " was not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  const RenderSettings plain = tests::make_settings(Integrator::kAntiderivative, 16, 12);
  RenderSettings settings = plain;
  settings.lighting.lights.emplace_back();
  expect_refusal("light", settings);
  settings = plain;
  settings.surfaces.push_back({0.5});
  expect_refusal("iso-surfaces", settings);
  settings = plain;
  settings.clipping.shapes.push_back({ClipPlane{}});
  expect_refusal("clipping", settings);
  settings = plain;
  settings.opacity_weight = OpacityWeight::kGradient;
  expect_refusal("opacity weights", settings);
  settings = plain;
  settings.wants_depth = true;
  expect_refusal("depths", settings);
  settings = plain;
  settings.integrator = Integrator::kPre;
  expect_refusal("pre", settings);
}

}  // namespace
}  // namespace tetravox::conformance
