/// Grids against the exact picture: filters x integrators x data x functions x cameras.

#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/reference/grid_integrator.h"

#include "tetravox/error.h"

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
/// Measured on fields of four cells a wave, and of noise, under functions of many narrow peaks.
constexpr Bound kFilteredBound{7e-2, 6e-3};
/// The same for a gentle function of the smooth ones among them.
constexpr Bound kGentleFilteredBound{8e-3, 6e-4};

/// A tolerance with what it promises. Down to 1e-4 a cell is at most twelve linear pieces
/// (docs/methods/classification.md), and so is the exact picture; below there are as many as it takes.
struct Precision {
  const char* name;
  double tolerance;
  int pieces_per_cell;
  Bound bound;
};
constexpr Precision kPrecisions[] = {
    {"default", 2e-3, 12, kDefaultBound}, {"fine", 1e-4, 12, kFineBound}, {"finest", 2e-5, 0, kFineBound}};

/// `name` says what is drawn, in the output and in failures.
void expect_agreement(const Image& actual, const Image& expected, const Bound& bound, const std::string& name) {
  const tests::ImageDifference difference = tests::compare_images(actual, expected);
  std::printf("%-64s max %.2e RMS %.2e\n", name.c_str(), difference.max, difference.rms);
  EXPECT_TRUE(tests::images_agree(actual, expected, bound.max, bound.rms)) << name;
}

/// Draws with each tolerance, and compares with the exact picture that it promises.
void expect_promises(const GridSubject& scene, const OpticalFunction& function, const reference::View& view,
                     const std::vector<RenderSettings>& methods, const std::string& name) {
  Renderer renderer(scene.grid);
  renderer.set_transfer_function(function);
  Image expected;
  int pieces = -1;
  for (const Precision& precision : kPrecisions) {
    if (precision.pieces_per_cell != pieces)
      expected = reference::draw(scene.grid.data, {{}, reference::Classification::kOfField, precision.pieces_per_cell},
                                 function, view);
    pieces = precision.pieces_per_cell;
    for (RenderSettings settings : methods) {
      settings.tolerance = precision.tolerance;
      expect_agreement(renderer.render(view.camera, settings), expected, precision.bound,
                       name + " " + name_of(settings.integrator) + " " + precision.name);
    }
  }
}

RenderSettings make_grid_settings(Integrator integrator, const Filter& filter, int width, int height) {
  RenderSettings settings = tests::make_settings(integrator, width, height);
  settings.filter = filter;
  settings.samples = 64;
  return settings;
}

/// Whether a filter's pictures are held against the exact ones. A kernel's field counts as trilinear between the nodes
/// of a finer lattice, which errs by more.
bool is_exact(const Filter& filter) {
  return filter.kind == FilterKind::kLinear || filter.kind == FilterKind::kNearest;
}

class GridPictures : public ::testing::TestWithParam<Filter> {};

TEST_P(GridPictures, AreDrawn) {
  const Filter filter = GetParam();
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    Renderer renderer(scene.grid);
    for (const char* function : {"smooth", "random"}) {
      renderer.set_transfer_function(scene.function(function));
      const reference::View view{scene.camera("outside"), 40, 30};
      const bool is_gentle = function == std::string("smooth") && grid_name != std::string("noise");
      const int pieces = is_exact(filter) ? kPrecisions[0].pieces_per_cell : 0;
      const Image expected =
          reference::draw(data, {filter, reference::Classification::kOfField, pieces}, scene.function(function), view);
      EXPECT_GT(tests::count_covered(expected), 200u) << grid_name;
      const RenderSettings settings = make_grid_settings(Integrator::kAntiderivative, filter, 40, 30);
      expect_agreement(renderer.render(view.camera, settings), expected,
                       is_exact(filter) ? kDefaultBound
                       : is_gentle      ? kGentleFilteredBound
                                        : kFilteredBound,
                       name_of(filter) + " " + grid_name + " " + function);
    }
  }
}

TEST_P(GridPictures, ArePreClassified) {
  const Filter filter = GetParam();
  if (filter.kind == FilterKind::kInterpolatingBspline) return;  // refused: see below
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    // Kernels with negative lobes make negative densities of narrow peaks, which no picture can show.
    const bool has_lobes = filter.kind == FilterKind::kLanczos || filter.kind == FilterKind::kCatmullRom;
    for (const char* function : {"smooth", "random"}) {
      if (has_lobes && (function == std::string("random") || grid_name == std::string("noise"))) continue;
      const reference::View view{scene.camera("outside"), 40, 30};
      const reference::GridMethod method{filter, reference::Classification::kOfValues};
      expect_agreement(render(scene.grid, scene.function(function), view.camera,
                              make_grid_settings(Integrator::kPre, filter, 40, 30)),
                       reference::draw(data, method, scene.function(function), view),
                       is_exact(filter) ? kDefaultBound : kFilteredBound,
                       name_of(filter) + " " + grid_name + " " + function + " pre");
    }
  }
}

TEST(PreClassification, HasNoInterpolatingSpline) {
  const GridSubject scene(make_hard_grids()[0].grid);
  const RenderSettings settings = make_grid_settings(Integrator::kPre, {FilterKind::kInterpolatingBspline}, 40, 30);
  try {
    render(scene.grid, scene.function("smooth"), scene.camera("outside"), settings);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("'bspline'"), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, GridPictures, ::testing::ValuesIn(all_filters()), [](const auto& test) {
  std::string name = name_of(test.param);
  for (char& c : name)
    if (c == '-' || c == '=') c = '_';
  return name;
});

std::vector<RenderSettings> exact_methods(int width, int height) {
  std::vector<RenderSettings> methods;
  for (const Integrator integrator : tests::kExactIntegrators)
    methods.push_back(make_grid_settings(integrator, {}, width, height));
  return methods;
}

/// All functions from several sides, with the default filter.
class LinearPictures : public ::testing::TestWithParam<const char*> {};

TEST_P(LinearPictures, AreAsExactAsTheTolerance) {
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    for (const auto& [function_name, function] : scene.functions)
      expect_promises(scene, function, {scene.camera(GetParam()), 48, 36}, exact_methods(48, 36),
                      std::string(grid_name) + " " + GetParam() + " " + function_name);
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, LinearPictures, ::testing::Values("outside", "inside", "orthographic"));

TEST(PostClassification, ApproachesTheExactPicture) {
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    for (const char* function : {"smooth", "random"}) {
      const reference::View view{scene.camera("outside"), 48, 36};
      const reference::GridMethod method{{}, reference::Classification::kOfField, kPrecisions[0].pieces_per_cell};
      expect_agreement(
          render(scene.grid, scene.function(function), view.camera, make_grid_settings(Integrator::kPost, {}, 48, 36)),
          reference::draw(data, method, scene.function(function), view), kDefaultBound,
          std::string(grid_name) + " " + function + " post");
    }
  }
}

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
    expect_promises(scene, function, view, exact_methods(64, 48), "peak of half width " + std::to_string(width));
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
    expect_promises(scene, function, view, exact_methods(64, 48), std::to_string(count) + " control points");
  }
}

}  // namespace
}  // namespace tetravox::conformance
