/// Grids: instruction sets x threads x integrators x filters give the same bytes; and what settings may not change.

#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"

#include <string>

namespace tetravox::conformance {
namespace {

class GridProduct : public ::testing::TestWithParam<Filter> {};

TEST_P(GridProduct, ThreadsRunsAndInstructionSetsGiveTheSameBytes) {
  ASSERT_FALSE(instruction_sets().empty());
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    for (const char* camera : {"outside", "plane"}) {
      for (const Integrator integrator : tests::kGridIntegrators) {
        const bool is_refused = integrator == Integrator::kPre && GetParam().kind == FilterKind::kInterpolatingBspline;
        if (is_refused) continue;
        for (const double rate : {0.0, 1.7}) {
          RenderSettings settings = tests::make_settings(integrator, 77, 53);
          settings.filter = GetParam();
          settings.samples_per_voxel = rate;
          settings.threads = 1;
          const Image first = render(scene.grid, scene.function("random"), scene.camera(camera), settings);
          const std::string where = name_of(GetParam()) + " " + grid_name + " " + camera + " " + name_of(integrator) +
                                    " rate " + std::to_string(rate) + " ";
          EXPECT_TRUE(tests::is_valid_picture(first)) << where;
          EXPECT_GT(tests::count_covered(first), 400u) << where;
          Renderer renderer(scene.grid);
          renderer.set_transfer_function(scene.function("random"));
          for (const std::string& instruction_set : instruction_sets()) {
            settings.instruction_set = instruction_set;
            for (const int threads : {1, 2, 5}) {
              settings.threads = threads;
              EXPECT_TRUE(tests::images_equal(renderer.render(scene.camera(camera), settings), first))
                  << where << instruction_set << ", threads " << threads;
            }
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, GridProduct,
                         ::testing::Values(Filter{FilterKind::kLinear}, Filter{FilterKind::kNearest},
                                           Filter{FilterKind::kBspline}, Filter{FilterKind::kInterpolatingBspline},
                                           Filter{FilterKind::kLanczos, 3}),
                         [](const auto& test) {
                           std::string name = name_of(test.param);
                           for (char& c : name)
                             if (c == '-' || c == '=') c = '_';
                           return name;
                         });

TEST(GridSettings, PreparingWithAnyNumberOfThreadsIsTheSame) {
  for (const auto& [name, data] : make_hard_grids()) {
    const PreparedGrid first = prepare_grid(data), second = prepare_grid(data);
    EXPECT_EQ(first.bricks.min.size(), second.bricks.min.size()) << name;
    EXPECT_EQ(first.bricks.has_missing, second.bricks.has_missing) << name;
    EXPECT_EQ(first.scalar_offset, second.scalar_offset) << name;
    const GridSubject scene(data);
    const RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 60, 45);
    EXPECT_TRUE(tests::images_equal(render(first, scene.function("random"), scene.camera("outside"), settings),
                                    render(second, scene.function("random"), scene.camera("outside"), settings)))
        << name;
  }
}

TEST(GridSettings, EarlyRayTerminationChangesNoEightBitPixel) {
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    for (const auto& [camera_name, camera] : scene.cameras) {
      for (const auto& [function_name, function] : scene.functions) {
        for (const Integrator integrator : tests::kGridIntegrators) {
          RenderSettings settings = tests::make_settings(integrator, 60, 45);
          RenderStatistics with, without;
          const Image early = tests::render_with(scene.grid, function, camera, settings, with);
          settings.use_early_ray_termination = false;
          const Image full = tests::render_with(scene.grid, function, camera, settings, without);
          const std::string where =
              std::string(grid_name) + " " + camera_name + " " + function_name + " " + name_of(integrator);
          EXPECT_LE(with.segments, without.segments) << where;
          EXPECT_TRUE(tests::images_agree(early, full, 1e-4)) << where;
          for (const float background : {0.0f, 0.25f, 0.5f, 0.8f, 1.0f})
            EXPECT_EQ(tests::largest_8bit_step(early, full, background), 0) << where << " over " << background;
        }
      }
    }
  }
}

TEST(GridSettings, EarlyRayTerminationSavesWorkInThickMedia) {
  tests::GridOptions options;
  options.dimensions = {65, 65, 65};
  const GridSubject scene(make_grid(options, tests::make_random_field(5, 3.0)));
  const OpticalFunction opaque{{{0.0, 1e4 / tests::diagonal_of(scene.grid.bounds), {1, 1, 1}}}};
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 120, 90);
  RenderStatistics with, without;
  tests::render_with(scene.grid, opaque, scene.camera("outside"), settings, with);
  settings.use_early_ray_termination = false;
  tests::render_with(scene.grid, opaque, scene.camera("outside"), settings, without);
  EXPECT_LT(10 * with.segments, 5 * without.segments);
}

TEST(GridSettings, SegmentsDoNotDependOnThreadsOrInstructionSet) {
  const GridSubject scene(make_hard_grids()[0].grid);
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 120, 90);
  RenderStatistics first;
  tests::render_with(scene.grid, scene.function("random"), scene.camera("outside"), settings, first);
  EXPECT_GT(first.segments, 10u * first.rays);
  EXPECT_GT(first.rays, 1000u);
  for (const std::string& instruction_set : instruction_sets()) {
    for (const int threads : {1, 3}) {
      settings.instruction_set = instruction_set;
      settings.threads = threads;
      RenderStatistics statistics;
      tests::render_with(scene.grid, scene.function("random"), scene.camera("outside"), settings, statistics);
      EXPECT_EQ(statistics.segments, first.segments) << instruction_set << " " << threads;
      EXPECT_EQ(statistics.rays, first.rays) << instruction_set << " " << threads;
    }
  }
}

TEST(GridSettings, ARendererKeepsNothingOfOtherSettings) {
  // One renderer, settings and functions in turns, is the same as a new one each time.
  for (const char* wanted : {"smooth", "cell_data", "uneven"}) {
    const std::vector<NamedGrid> grids = make_hard_grids();
    const GridSubject scene(
        std::find_if(grids.begin(), grids.end(), [&](const auto& g) { return std::string(g.name) == wanted; })->grid);
    Renderer renderer(scene.grid);
    for (int round = 0; round < 2; ++round) {
      for (const Filter& filter : all_filters()) {
        for (const char* function : {"smooth", "spikes"}) {
          renderer.set_transfer_function(scene.function(function));
          for (const double tolerance : {2e-3, 1e-5}) {
            RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 40, 30);
            settings.filter = filter;
            settings.tolerance = tolerance;
            const Camera& camera = scene.camera(round == 0 ? "outside" : "near");
            EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings),
                                            render(scene.grid, scene.function(function), camera, settings)))
                << wanted << " " << name_of(filter) << " " << function << " " << tolerance;
          }
        }
      }
    }
  }
}

TEST(GridSettings, AnEyeAmongTheBricksCostsLittleMemory) {
  // Bricks behind the eye are seen by no tile.
  tests::GridOptions options;
  options.dimensions = {97, 97, 97};
  const GridSubject scene(make_grid(options, tests::make_random_field(8, 2.0)));
  Renderer renderer(scene.grid);
  renderer.set_transfer_function(scene.function("smooth"));
  const RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 512, 512);
  renderer.render(scene.camera("outside"), settings);
  const std::uint64_t outside = renderer.bytes();
  const Image image = renderer.render(scene.camera("inside"), settings);
  EXPECT_EQ(tests::count_covered(image), 512u * 512u);
  EXPECT_LT(renderer.bytes(), outside + 1'000'000);
}

TEST(GridSettings, ARayDoesNotDependOnItsNeighbours) {
  // Cells of optical depth 1/4, the border between two formulas, beside cells that are thicker.
  tests::GridOptions options;
  options.dimensions = {9, 9, 9};
  const GridSubject scene(make_grid(options, [](const Vector3& p) { return p[0] > 0 ? 1.0 : 0.0; }));
  const double cell = (scene.grid.bounds[2].max - scene.grid.bounds[2].min) / 8.0;
  const OpticalFunction function{{{0.0, 0.25 / cell, {0.9, 0.5, 0.1}}, {1.0, 3.0 / cell, {0.1, 0.5, 0.9}}}};
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 61, 47);
  const Image first = render(scene.grid, function, scene.camera("orthographic"), settings);
  for (const std::string& instruction_set : instruction_sets()) {
    settings.instruction_set = instruction_set;
    EXPECT_TRUE(tests::images_equal(render(scene.grid, function, scene.camera("orthographic"), settings), first))
        << instruction_set;
  }
}

TEST(GridSettings, AGridOutOfSightLeavesThePictureEmpty) {
  const GridSubject scene(make_hard_grids()[0].grid);
  Camera camera = scene.camera("outside");
  for (int k = 0; k < 3; ++k) camera.focal_point[k] = 2.0 * camera.position[k] - camera.focal_point[k];
  for (const Integrator integrator : tests::kGridIntegrators) {
    const Image image = render(scene.grid, scene.function("thick"), camera, tests::make_settings(integrator, 64, 48));
    for (const float value : image.pixels) ASSERT_EQ(value, 0.0f);
  }
}

TEST(GridSettings, EveryPixelOfOddPicturesIsDrawn) {
  tests::GridOptions options;
  const GridSubject scene(make_grid(options, tests::make_random_field(6, 2.0)));
  const OpticalFunction function{{{0.0, 2.0, {1.0, 0.5, 0.25}}}};
  const std::pair<int, int> sizes[] = {{1, 1}, {2, 1}, {1, 5}, {333, 17}, {17, 333}, {1, 16384}, {16384, 1}, {65, 63}};
  for (const auto& [width, height] : sizes) {
    Camera camera = scene.camera("inside");
    camera.view_angle = height > 100 * width ? 120.0 : 50.0;
    for (const Integrator integrator : tests::kGridIntegrators) {
      const Image image = render(scene.grid, function, camera, tests::make_settings(integrator, width, height));
      ASSERT_EQ(image.pixels.size(), 4u * width * height);
      EXPECT_TRUE(tests::is_valid_picture(image));
      EXPECT_EQ(tests::count_covered(image), static_cast<std::size_t>(width) * height)
          << width << "x" << height << " " << name_of(integrator);
    }
  }
}

}  // namespace
}  // namespace tetravox::conformance
