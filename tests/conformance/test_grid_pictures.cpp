/// Grids against the exact picture: filters x integrators x data x functions x cameras.

#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/reference/grid_integrator.h"

#include <cstdio>
#include <string>

namespace tetravox::conformance {
namespace {

/// What a picture may err by, in the worst pixel and over all pixels.
struct Bound {
  double max, rms;
};
constexpr Bound kDefaultBound{4e-3, 3e-4};
constexpr Bound kFineBound{1e-3, 1e-4};
constexpr double kFineTolerance = 1e-4;

/// `name` says what is drawn, in the output and in failures.
void expect_agreement(const Image& actual, const Image& expected, const Bound& bound, const std::string& name) {
  const tests::ImageDifference difference = tests::compare_images(actual, expected);
  std::printf("%-64s max %.2e RMS %.2e\n", name.c_str(), difference.max, difference.rms);
  EXPECT_TRUE(tests::images_agree(actual, expected, bound.max, bound.rms)) << name;
}

RenderSettings make_grid_settings(Integrator integrator, const Filter& filter, int width, int height) {
  RenderSettings settings = tests::make_settings(integrator, width, height);
  settings.filter = filter;
  settings.samples = 64;
  return settings;
}

class GridPictures : public ::testing::TestWithParam<Filter> {};

TEST_P(GridPictures, AreDrawn) {
  const Filter filter = GetParam();
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    Renderer renderer(scene.grid);
    for (const char* function : {"smooth", "steps", "random"}) {
      renderer.set_transfer_function(scene.function(function));
      for (const char* camera : {"outside", "inside"}) {
        const reference::View view{scene.camera(camera), 40, 30};
        const Image expected = reference::draw(data, {filter}, scene.function(function), view);
        EXPECT_GT(tests::count_covered(expected), 200u) << grid_name << " " << camera;
        for (const Integrator integrator : tests::kAllIntegrators) {
          RenderSettings settings = make_grid_settings(integrator, filter, 40, 30);
          const std::string name =
              name_of(filter) + " " + grid_name + " " + camera + " " + function + " " + name_of(integrator);
          expect_agreement(renderer.render(view.camera, settings), expected, kDefaultBound, name);
          settings.tolerance = kFineTolerance;
          expect_agreement(renderer.render(view.camera, settings), expected, kFineBound, name + " fine");
        }
      }
    }
  }
}

TEST_P(GridPictures, ArePreClassified) {
  const Filter filter = GetParam();
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    for (const char* function : {"smooth", "random"}) {
      const reference::View view{scene.camera("outside"), 40, 30};
      const reference::GridMethod method{filter, reference::Classification::kOfValues};
      expect_agreement(render(scene.grid, scene.function(function), view.camera,
                              make_grid_settings(Integrator::kPre, filter, 40, 30)),
                       reference::draw(data, method, scene.function(function), view), kDefaultBound,
                       name_of(filter) + " " + grid_name + " " + function + " pre");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, GridPictures, ::testing::ValuesIn(all_filters()), [](const auto& test) {
  std::string name = name_of(test.param);
  for (char& c : name)
    if (c == '-' || c == '=') c = '_';
  return name;
});

/// All cameras and functions, with the default filter.
class LinearPictures : public ::testing::TestWithParam<Integrator> {};

TEST_P(LinearPictures, AreDrawnFromEverywhere) {
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    Renderer renderer(scene.grid);
    for (const auto& [function_name, function] : scene.functions) {
      renderer.set_transfer_function(function);
      for (const auto& [camera_name, camera] : scene.cameras) {
        const Image expected = reference::draw(data, {}, function, {camera, 48, 36});
        RenderSettings settings = make_grid_settings(GetParam(), {}, 48, 36);
        const std::string name =
            std::string(grid_name) + " " + camera_name + " " + function_name + " " + name_of(GetParam());
        expect_agreement(renderer.render(camera, settings), expected, kDefaultBound, name);
        settings.tolerance = kFineTolerance;
        expect_agreement(renderer.render(camera, settings), expected, kFineBound, name + " fine");
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, LinearPictures, ::testing::ValuesIn(tests::kAllIntegrators),
                         [](const auto& test) { return name_of(test.param); });

TEST(GridFunctions, MayBeNarrow) {
  const GridSubject scene(make_hard_grids()[0].grid);
  const ValueRange range = scene.grid.scalar_range;
  const double middle = range.min + 0.61 * (range.max - range.min);
  for (const double width : {1e-2, 1e-3, 1e-4}) {
    const double half = width * (range.max - range.min);
    // The peak's area stays the same.
    const double peak = 0.05 / half;
    OpticalFunction function{{{middle - half, 0.0, {0.9, 0.5, 0.1}},
                              {middle, peak, {0.9, 0.8, 0.2}},
                              {middle + half, 0.0, {0.2, 0.5, 0.9}}}};
    const reference::View view{scene.camera("outside"), 64, 48};
    const Image expected = reference::draw(scene.grid.data, {}, function, view);
    for (const Integrator integrator : tests::kExactIntegrators) {
      RenderSettings settings = make_grid_settings(integrator, {}, 64, 48);
      const std::string name = "peak of half width " + std::to_string(width) + " " + name_of(integrator);
      expect_agreement(render(scene.grid, function, view.camera, settings), expected, kDefaultBound, name);
      settings.tolerance = kFineTolerance;
      expect_agreement(render(scene.grid, function, view.camera, settings), expected, kFineBound, name + " fine");
    }
  }
}

TEST(GridFunctions, MayHaveThousandsOfControlPoints) {
  const GridSubject scene(make_hard_grids()[0].grid);
  for (const int count : {300, 3000}) {
    OpticalFunction function;
    for (int i = 0; i < count; ++i) {
      const double u = i / (count - 1.0), wave = 0.5 + 0.5 * std::sin(i * 2.399963);
      function.points.push_back(
          {scene.grid.scalar_range.min + u * (scene.grid.scalar_range.max - scene.grid.scalar_range.min),
           20.0 * wave / tests::diagonal_of(scene.grid.bounds),
           {wave, u, 0.5 + 0.5 * std::cos(i * 1.7)}});
    }
    const reference::View view{scene.camera("outside"), 64, 48};
    const Image expected = reference::draw(scene.grid.data, {}, function, view);
    for (const Integrator integrator : tests::kExactIntegrators)
      expect_agreement(render(scene.grid, function, view.camera, make_grid_settings(integrator, {}, 64, 48)), expected,
                       kDefaultBound, std::to_string(count) + " control points " + name_of(integrator));
  }
}

TEST(GridRates, ConvergeToTheExactPicture) {
  const GridSubject scene(make_hard_grids()[0].grid);
  const reference::View view{scene.camera("outside"), 64, 48};
  for (const char* function : {"smooth", "steps", "random"}) {
    const Image expected = reference::draw(scene.grid.data, {}, scene.function(function), view);
    for (const Integrator integrator : tests::kExactIntegrators) {
      double before = 1.0;
      for (const double rate : {1.0, 4.0, 16.0, 64.0}) {
        RenderSettings settings = make_grid_settings(integrator, {}, 64, 48);
        settings.samples_per_voxel = rate;
        const tests::ImageDifference difference =
            tests::compare_images(render(scene.grid, scene.function(function), view.camera, settings), expected);
        std::printf("%s %s, %g samples a voxel: max %.2e RMS %.2e\n", function, name_of(integrator).c_str(), rate,
                    difference.max, difference.rms);
        EXPECT_LT(difference.rms, std::max(before / 4.0, 3e-4))
            << function << " " << name_of(integrator) << " " << rate;
        before = difference.rms;
      }
    }
  }
}

}  // namespace
}  // namespace tetravox::conformance
