/// Instruction sets x threads x integrators x cameras: the same bytes; and what settings may not change.

#include "tests/common/image_compare.h"
#include "tests/conformance/scenes.h"

#include <cstdio>

namespace tetravox::conformance {
namespace {

class Product : public ::testing::TestWithParam<std::string> {};

TEST_P(Product, ThreadsRunsAndInstructionSetsGiveTheSamePicture) {
  const Subject scene = GetParam() == "cell_data" ? make_subject(make_cell_data_mesh()) : make_subject(GetParam());
  ASSERT_FALSE(instruction_sets().empty());
  for (const auto& [camera_name, camera] : scene.cameras) {
    for (const char* function : {"random", "steps", "thick"}) {
      for (const Integrator integrator : tests::kAllIntegrators) {
        RenderSettings settings = tests::make_settings(integrator, 77, 53);
        settings.threads = 1;
        const Image best = render(scene.mesh, scene.function(function), camera, settings);
        for (const std::string& instruction_set : instruction_sets()) {
          Renderer renderer(scene.mesh);
          renderer.set_transfer_function(scene.function(function));
          settings.instruction_set = instruction_set;
          settings.threads = 1;
          const Image one_thread = renderer.render(camera, settings);
          const std::string where = camera_name + " " + function + " " + name_of(integrator) + " " + instruction_set;
          EXPECT_TRUE(tests::is_valid_picture(one_thread)) << where;
          EXPECT_TRUE(tests::images_agree(one_thread, best, 1e-5)) << where;
          for (const int threads : {1, 2, 3, 0}) {
            settings.threads = threads;
            RenderStatistics statistics;
            EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings, &statistics), one_thread))
                << where << ", threads " << threads;
            EXPECT_EQ(statistics.instruction_set, instruction_set);
            EXPECT_EQ(statistics.stopped_rays, 0u) << where;
          }
          settings.instruction_set.clear();
        }
      }
    }
  }
}

TEST_P(Product, AllInstructionSetsGiveTheSameBytes) {
  const Subject scene = GetParam() == "cell_data" ? make_subject(make_cell_data_mesh()) : make_subject(GetParam());
  for (const Integrator integrator : tests::kAllIntegrators) {
    RenderSettings settings = tests::make_settings(integrator, 160, 120);
    const Image best = render(scene.mesh, scene.function("random"), scene.camera("outside"), settings);
    for (const std::string& instruction_set : instruction_sets()) {
      settings.instruction_set = instruction_set;
      EXPECT_TRUE(
          tests::images_equal(render(scene.mesh, scene.function("random"), scene.camera("outside"), settings), best))
          << name_of(integrator) << " " << instruction_set;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Data, Product,
                         ::testing::Values("sphere", "buckyball?cells=20000", "duct?cells=4000", "cell_data"),
                         [](const auto& test) {
                           const std::string name = test.param;
                           return name.substr(0, name.find('?'));
                         });

TEST(Settings, EarlyRayTerminationChangesNoEightBitPixel) {
  for (const char* builtin : {"sphere", "buckyball?cells=20000", "duct"}) {
    const Subject scene = make_subject(builtin);
    for (const auto& [camera_name, camera] : scene.cameras) {
      for (const auto& [function_name, function] : scene.functions) {
        for (const Integrator integrator : tests::kAllIntegrators) {
          RenderSettings settings = tests::make_settings(integrator, 120, 90);
          RenderStatistics with, without;
          const Image early = tests::render_with(scene.mesh, function, camera, settings, with);
          settings.use_early_ray_termination = false;
          const Image full = tests::render_with(scene.mesh, function, camera, settings, without);
          const std::string where =
              std::string(builtin) + " " + camera_name + " " + function_name + " " + name_of(integrator);
          EXPECT_LE(with.segments, without.segments) << where;
          EXPECT_TRUE(tests::images_agree(early, full, 5e-4)) << where;
          for (const float background : {0.0f, 0.25f, 0.5f, 0.8f, 1.0f})
            EXPECT_EQ(tests::largest_8bit_step(early, full, background), 0) << where << " over " << background;
        }
      }
    }
  }
}

TEST(Settings, EarlyRayTerminationSavesWorkInThickMedia) {
  const Subject scene = make_subject("buckyball?cells=20000");
  OpticalFunction opaque{{{0.0, 1e4 / tests::diagonal_of(scene.mesh.bounds), {1, 1, 1}}}};
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 120, 90);
  RenderStatistics with, without;
  tests::render_with(scene.mesh, opaque, scene.camera("outside"), settings, with);
  settings.use_early_ray_termination = false;
  tests::render_with(scene.mesh, opaque, scene.camera("outside"), settings, without);
  EXPECT_LT(10 * with.segments, 3 * without.segments);
}

TEST(Settings, SegmentsDoNotDependOnThreadsOrInstructionSet) {
  const Subject scene = make_subject("duct");
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 120, 90);
  RenderStatistics first;
  tests::render_with(scene.mesh, scene.function("smooth"), scene.camera("outside"), settings, first);
  EXPECT_GT(first.segments, 10u * first.rays);
  EXPECT_GT(first.rays, 1000u);
  for (const std::string& instruction_set : instruction_sets()) {
    for (const int threads : {1, 3}) {
      settings.instruction_set = instruction_set;
      settings.threads = threads;
      RenderStatistics statistics;
      tests::render_with(scene.mesh, scene.function("smooth"), scene.camera("outside"), settings, statistics);
      EXPECT_EQ(statistics.segments, first.segments) << instruction_set << " " << threads;
      EXPECT_EQ(statistics.rays, first.rays) << instruction_set << " " << threads;
    }
  }
}

struct Size {
  int width, height;
};

void PrintTo(const Size& size, std::ostream* out) { *out << size.width << "x" << size.height; }

/// Every pixel of an odd-sized picture is the pixel of an exact picture: nothing lost in tiles and packets.
class Resolutions : public ::testing::TestWithParam<Size> {};

TEST_P(Resolutions, EveryPixelIsDrawn) {
  const auto [width, height] = GetParam();
  const PreparedMesh mesh = prepare_mesh(make_builtin("sphere").mesh);
  const OpticalFunction function{{{mesh.scalar_range.min, 2.0, {1.0, 0.5, 0.25}}}};
  Camera camera;
  camera.position = {0.01, 0.02, 0.03};
  for (int k = 0; k < 3; ++k) camera.position[k] += 0.5 * (mesh.bounds[k].min + mesh.bounds[k].max);
  camera.focal_point = camera.position;
  camera.focal_point[0] += 1.0;
  camera.view_angle = height > 100 * width ? 120.0 : 50.0;
  camera.view_up = {0, 0, 1};
  for (const Integrator integrator : tests::kAllIntegrators) {
    const Image image = render(mesh, function, camera, tests::make_settings(integrator, width, height));
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, height);
    ASSERT_EQ(image.pixels.size(), 4u * width * height);
    EXPECT_TRUE(tests::is_valid_picture(image));
    // The eye is inside a convex mesh: every ray gathers something.
    EXPECT_EQ(tests::count_covered(image), static_cast<std::size_t>(width) * height) << name_of(integrator);
  }
}

INSTANTIATE_TEST_SUITE_P(Odd, Resolutions,
                         ::testing::Values(Size{1, 1}, Size{2, 1}, Size{1, 5}, Size{333, 17}, Size{17, 333},
                                           Size{1, 16384}, Size{16384, 1}, Size{64, 64}, Size{65, 63}),
                         [](const auto& test) {
                           return std::to_string(test.param.width) + "x" + std::to_string(test.param.height);
                         });

TEST(Settings, AMeshOutOfSightLeavesThePictureEmpty) {
  const Subject scene = make_subject("sphere");
  Camera camera = scene.camera("outside");
  for (int k = 0; k < 3; ++k) camera.focal_point[k] = 2.0 * camera.position[k] - camera.focal_point[k];
  for (const Integrator integrator : tests::kAllIntegrators) {
    const Image image = render(scene.mesh, scene.function("thick"), camera, tests::make_settings(integrator, 64, 48));
    for (const float value : image.pixels) ASSERT_EQ(value, 0.0f);
  }
}

}  // namespace
}  // namespace tetravox::conformance
