/// OpenGL draws the pictures of the CPU, and the exact ones: grids.

#include "src/gl/context.h"
#include "src/gl/filtered_nodes.h"
#include "src/gl/march_passes.h"
#include "src/scene/grid_view.h"
#include "tests/common/gl.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/reference/grid_integrator.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tetravox::conformance {
namespace {

/// How far the pictures of two backends may be apart: cells are met a hair earlier or later.
constexpr double kMostApart = 3e-3, kMostApartRms = 3e-4;
/// Point samples are all or nothing: where the number of a cell's pieces, or the cell of a sample, is decided by
/// rounding, single pixels differ. So many of a thousand may.
constexpr int kApartOfThousand = 10;
/// Of slabs: where a ray enters or leaves it passes a part of one, which OpenGL takes to be of one colour.
constexpr double kSlabsApart = 1e-2, kSlabsApartRms = 5e-4;
/// What both promise to err by (test_grid_pictures.cpp).
constexpr double kMostWrong = 4e-3, kMostWrongRms = 3e-4;

/// Two renderers of one grid.
struct Pair {
  explicit Pair(const PreparedGrid& grid)
      : gl(make_gl_renderer(grid)), cpu(grid), has_missing(grid.missing_values > 0) {}

  void set_transfer_function(const OpticalFunction& function) {
    gl.set_transfer_function(function);
    cpu.set_transfer_function(function);
  }
  void expect_same(const Camera& camera, const RenderSettings& settings, const std::string& where) {
    RenderStatistics drawn, expected;
    const Image image = gl.render(camera, settings, &drawn);
    const Image same = cpu.render(camera, settings, &expected);
    EXPECT_TRUE(tests::is_valid_picture(image)) << where;
    const bool has_rate = settings.samples_per_voxel > 0.0;
    const bool is_sampled = settings.integrator == Integrator::kPost ||
                            (has_rate && (has_missing || settings.integrator == Integrator::kPre));
    if (is_sampled)
      EXPECT_LE(1000 * tests::count_apart(image, same, kMostApart), kApartOfThousand * image.width * image.height)
          << where;
    else
      EXPECT_TRUE(tests::images_agree(image, same, kMostApart, kMostApartRms)) << where;
    EXPECT_EQ(drawn.backend, "gl");
    EXPECT_FALSE(drawn.device.empty());
    // A ray along a border meets the bricks on one side or on the other.
    EXPECT_NEAR(static_cast<double>(drawn.rays), static_cast<double>(expected.rays), 0.01 * 77 * 53) << where;
    EXPECT_NEAR(static_cast<double>(drawn.segments), static_cast<double>(expected.segments),
                100.0 + 0.02 * static_cast<double>(expected.segments))
        << where;
  }

  Renderer gl, cpu;
  bool has_missing = false;
};

std::string text_of(const Filter& filter, Integrator integrator, double rate) {
  return name_of(filter) + " " + name_of(integrator) + " rate " + std::to_string(rate);
}

bool is_refused(const Filter& filter, Integrator integrator) {
  return integrator == Integrator::kPre && filter.kind == FilterKind::kInterpolatingBspline;
}

class GlGrids : public ::testing::TestWithParam<std::string> {
 protected:
  static GridData grid() {
    const std::vector<NamedGrid> grids = make_hard_grids();
    return std::find_if(grids.begin(), grids.end(), [](const auto& g) { return g.name == GetParam(); })->grid;
  }
};

TEST_P(GlGrids, PicturesAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid());
  Pair pair(scene.grid);
  for (const auto& [function_name, function] : scene.functions) {
    pair.set_transfer_function(function);
    for (const auto& [camera_name, camera] : scene.cameras)
      for (const Integrator integrator : tests::kGridIntegrators)
        for (const FilterKind filter : {FilterKind::kLinear, FilterKind::kNearest}) {
          RenderSettings settings = tests::make_settings(integrator, 77, 53);
          settings.filter = {filter};
          pair.expect_same(camera, settings,
                           camera_name + " " + function_name + " " + text_of(settings.filter, integrator, 0.0));
        }
  }
}

TEST_P(GlGrids, FiltersAndRatesAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid());
  Pair pair(scene.grid);
  for (const char* function : {"smooth", "random"}) {
    pair.set_transfer_function(scene.function(function));
    for (const Filter& filter : all_filters())
      for (const Integrator integrator : tests::kGridIntegrators)
        for (const double rate : {0.0, 1.7}) {
          if (is_refused(filter, integrator)) continue;
          RenderSettings settings = tests::make_settings(integrator, 77, 53);
          settings.filter = filter;
          settings.samples_per_voxel = rate;
          pair.expect_same(scene.camera("outside"), settings,
                           std::string(function) + " " + text_of(filter, integrator, rate));
        }
  }
}

TEST_P(GlGrids, PicturesAreExact) {
  TETRAVOX_REQUIRE_GL();
  const GridData data = grid();
  const GridSubject scene(data);
  Renderer renderer = make_gl_renderer(scene.grid);
  const reference::View view{scene.camera("outside"), 40, 30};
  for (const auto& [name, function] : scene.functions) {
    renderer.set_transfer_function(function);
    const Image expected = reference::draw(data, {{}, reference::Classification::kOfField, 12}, function, view);
    for (const Integrator integrator : tests::kExactIntegrators)
      EXPECT_TRUE(tests::images_agree(renderer.render(view.camera, tests::make_settings(integrator, 40, 30)), expected,
                                      kMostWrong, kMostWrongRms))
          << name << " " << name_of(integrator);
  }
}

TEST_P(GlGrids, EarlyRayTerminationChangesNoEightBitPixel) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid());
  Renderer renderer = make_gl_renderer(scene.grid);
  renderer.set_transfer_function(scene.function("thick"));
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 60, 45);
  RenderStatistics with, without;
  const Image early = renderer.render(scene.camera("outside"), settings, &with);
  settings.use_early_ray_termination = false;
  const Image full = renderer.render(scene.camera("outside"), settings, &without);
  EXPECT_LE(with.segments, without.segments);
  for (const float background : {0.0f, 0.5f, 1.0f}) EXPECT_EQ(tests::largest_8bit_step(early, full, background), 0);
}

INSTANTIATE_TEST_SUITE_P(Hard, GlGrids,
                         ::testing::Values("smooth", "marschner_lobb", "bytes", "uneven", "sheared", "cell_data",
                                           "holes", "noise"),
                         [](const auto& test) { return test.param; });

TEST(GlGridTypes, EveryNumberTypeAndComponent) {
  TETRAVOX_REQUIRE_GL();
  const tests::Field field = tests::make_random_field(21, 2.0), other = tests::make_random_field(3, 2.0);
  for (const ScalarType type : tests::kAllScalarTypes)
    for (const int component : {0, 1, kMagnitude}) {
      tests::GridOptions options;
      options.type = type;
      const double size = type == ScalarType::kFloat32 || type == ScalarType::kFloat64 ? 1.0 : 100.0;
      const GridSubject scene(tests::make_vector_grid(
          options,
          {[&](const Vector3& p) { return size * other(p); }, [&](const Vector3& p) { return size * field(p) - 3.0; }},
          component));
      Pair pair(scene.grid);
      pair.set_transfer_function(scene.function("smooth"));
      pair.expect_same(scene.camera("outside"), tests::make_settings(Integrator::kAntiderivative, 77, 53),
                       scalar_type_name(type) + " " + std::to_string(component));
    }
}

TEST(GlGridPasses, RaysThroughManyBricksGoOnInFurtherPasses) {
  TETRAVOX_REQUIRE_GL();
  tests::GridOptions options;
  options.dimensions = {1201, 3, 3};  // 150 bricks along the view
  options.lower = {-100, -1, -1};
  options.upper = {100, 1, 1};
  const GridSubject scene(make_grid(options, tests::make_random_field(4, 3.0)));
  Pair pair(scene.grid);
  Camera camera = scene.camera("outside");
  camera.position = {-110.0, 0.05, 0.02};
  camera.focal_point = {0.0, 0.0, 0.0};
  camera.view_up = {0.0, 0.0, 1.0};
  for (const char* function : {"smooth", "random"}) {
    pair.set_transfer_function(scene.function(function));
    for (const double rate : {0.0, 1.3})
      for (const Integrator integrator : tests::kGridIntegrators) {
        RenderSettings settings = tests::make_settings(integrator, 77, 53);
        settings.samples_per_voxel = rate;
        pair.expect_same(camera, settings, std::string(function) + " " + text_of({}, integrator, rate));
      }
  }
}

/// Slabs are looked up; functions and tolerances that ask for new ones.
TEST_P(GlGrids, SlabsAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid());
  Pair pair(scene.grid);
  for (const char* function : {"smooth", "thick", "steps", "random", "smooth"}) {
    pair.set_transfer_function(scene.function(function));
    for (const double tolerance : {0.1, 0.02})
      for (const double rate : {0.8, 3.0}) {
        RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 77, 53);
        settings.samples_per_voxel = rate;
        settings.tolerance = tolerance;
        settings.use_early_ray_termination = false;  // rays of a packet end runs together
        EXPECT_TRUE(tests::images_agree(pair.gl.render(scene.camera("outside"), settings),
                                        pair.cpu.render(scene.camera("outside"), settings), kSlabsApart,
                                        kSlabsApartRms))
            << function << " " << tolerance << " " << rate;
      }
  }
}

/// Values that the device interpolates, four in a texel, and slices, of one renderer in turns.
TEST(GlGridPasses, ValuesAreInterpolatedHereAndThere) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(make_hard_grids()[0].grid);
  Pair pair(scene.grid);
  pair.set_transfer_function(scene.function("smooth"));
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 77, 53);
  settings.samples_per_voxel = 0.8;
  settings.tolerance = 0.1;
  RenderSettings precise = settings, sliced = settings;
  precise.tolerance = 1e-5;
  sliced.source = Source::kSlices;
  sliced.samples_per_voxel = 0.0;
  const Camera& camera = scene.camera("outside");
  const Image first = pair.gl.render(camera, settings);
  const Image slices = pair.gl.render(camera, sliced);
  const Image exact = pair.gl.render(camera, precise);
  EXPECT_TRUE(tests::images_equal(pair.gl.render(camera, settings), first));
  EXPECT_TRUE(tests::images_equal(pair.gl.render(camera, sliced), slices));
  EXPECT_TRUE(tests::images_equal(pair.gl.render(camera, precise), exact));
  EXPECT_TRUE(tests::images_agree(exact, pair.cpu.render(camera, precise), 3e-3, 3e-4));
}

TEST(GlGridPasses, NodesThatDoNotFitComeInTurns) {
  TETRAVOX_REQUIRE_GL();
  tests::GridOptions options;
  options.dimensions = {65, 65, 65};
  const GridSubject scene(make_grid(options, tests::make_random_field(5, 3.0)));
  const Filter filter{FilterKind::kBspline};
  const scene::FilteredField field = scene::make_filtered_field(scene.grid, filter);
  optics::SteepnessTable steepness;
  const optics::ControlPointTable points =
      optics::build_control_point_table(scene.function("smooth"), {scene.grid.scalar_offset, scene.grid.scalar_scale});
  optics::build_steepness_table(points, -2.0f, 2.0f, steepness);
  const scene::PlanSources sources{&scene.grid, &field, &steepness, 1e-3f, 1.0, false, false, {}};
  scene::PlanSettings settings;
  settings.filter = filter;
  const std::vector<scene::BrickPlan> plans = scene::plan_bricks(sources, settings);
  const gl::FilteredBricks bricks{&sources, &plans, {field.reader.get(), 0, field.kernel.get(), 2, 1e-9f}, nullptr};
  const grid::GridFrame frame = grid::make_grid_frame(scene.grid.data.shape);
  const scene::GridView view = scene::make_grid_view(scene.grid, frame, scene.camera("outside"), 64, 64);

  const auto context = gl::Context::open({});
  const auto current = context->make_current();
  gl::Limits limits = context->limits();
  limits.buffer_texels = 100 * 17 * 17 * 17;  // of 512 bricks
  gl::FilteredNodes nodes;
  nodes.begin(frame, view, bricks, limits);
  std::vector<int> times(plans.size(), 0);
  int turns = 0;
  for (bool has_more = true; has_more; ++turns) {
    std::vector<gl::NodePlace> places;
    has_more = nodes.next(bricks, {}, places);
    for (std::size_t i = 0; i < places.size(); ++i) times[i] += places[i].parts > 0 ? 1 : 0;
    EXPECT_LE(nodes.bytes(), limits.buffer_texels * sizeof(float));
  }
  EXPECT_GE(turns, 6);
  for (std::size_t i = 0; i < plans.size(); ++i)
    EXPECT_EQ(times[i], plans[i].level == scene::BrickPlan::kTransparent ? 0 : 1) << i;
}

TEST(GlGridPasses, EveryProgramIsCompiled) {
  TETRAVOX_REQUIRE_GL();
  const auto context = gl::Context::open({});
  const auto current = context->make_current();
  for (const gl::MarchKind& kind : gl::march_kinds()) {
    const gl::ShaderRecipe recipe = gl::recipe_of_march(kind);
    EXPECT_NO_THROW(gl::make_program(std::span(&recipe, 1))) << name_of(kind.integrator);
  }
}

TEST(GlGridRefusals, SayWhatIsNotDrawnYet) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(make_hard_grids()[0].grid);
  Renderer renderer = make_gl_renderer(scene.grid);
  renderer.set_transfer_function(scene.function("smooth"));
  const auto expect_refused = [&](const RenderSettings& settings, const std::string& what) {
    try {
      renderer.render(scene.camera("outside"), settings);
      FAIL() << what;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  };
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 20, 20);
  settings.surfaces.push_back({});
  expect_refused(settings, "iso-surfaces");
  settings = tests::make_settings(Integrator::kAntiderivative, 20, 20);
  settings.wants_depth = true;
  expect_refused(settings, "depths");
  settings = tests::make_settings(Integrator::kPre, 20, 20);
  settings.filter = {FilterKind::kInterpolatingBspline};
  expect_refused(settings, "'bspline'");
}

TEST(GlGridRefusals, SayWhatADeviceCannotHold) {
  TETRAVOX_REQUIRE_GL();
  const auto most = static_cast<std::uint32_t>(gl::Context::open({})->limits().volume_size);
  tests::GridOptions options;
  options.dimensions = {most + 1, 2, 2};
  options.type = ScalarType::kUint8;
  const GridSubject scene(make_grid(options, [](const Vector3& p) { return 100.0 + 90.0 * p[0]; }));
  try {
    make_gl_renderer(scene.grid);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(most + 1) + " values along an axis"), std::string::npos)
        << error.what();
    EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
  }
}

TEST(GlGridSettings, ARendererKeepsNothingOfOtherSettings) {
  TETRAVOX_REQUIRE_GL();
  for (const char* wanted : {"smooth", "cell_data"}) {
    const std::vector<NamedGrid> grids = make_hard_grids();
    const GridSubject scene(
        std::find_if(grids.begin(), grids.end(), [&](const auto& g) { return std::string(g.name) == wanted; })->grid);
    Renderer renderer = make_gl_renderer(scene.grid);
    for (int round = 0; round < 2; ++round)
      for (const Filter& filter : all_filters())
        for (const char* function : {"smooth", "spikes"}) {
          renderer.set_transfer_function(scene.function(function));
          RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 40, 30);
          settings.filter = filter;
          Renderer fresh = make_gl_renderer(scene.grid);
          fresh.set_transfer_function(scene.function(function));
          const Camera& camera = scene.camera(round == 0 ? "outside" : "near");
          EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings), fresh.render(camera, settings)))
              << wanted << " " << name_of(filter) << " " << function;
        }
  }
}

/// As many as asked for, in as many passes as that needs: passes end wherever a ray is.
TEST(GlGrid, SegmentsMayHaveManySamples) {
  TETRAVOX_REQUIRE_GL();
  for (const NamedGrid& named : make_hard_grids()) {
    const GridSubject scene(named.grid);
    Pair pair(scene.grid);
    pair.set_transfer_function(scene.function("smooth"));
    for (const int samples : {50, 1000}) {
      RenderSettings settings = tests::make_settings(Integrator::kPost, 20, 15);
      settings.samples = samples;
      EXPECT_TRUE(tests::images_agree(pair.gl.render(scene.cameras[0].camera, settings),
                                      pair.cpu.render(scene.cameras[0].camera, settings), 3e-3, 3e-4))
          << named.name << " " << samples;
    }
  }
}

/// Thousands of control points in a hair of the range, where looking one of them up takes a search.
TEST(GlGrid, FunctionsMayHaveThousandsOfPoints) {
  TETRAVOX_REQUIRE_GL();
  const std::vector<NamedGrid> grids = make_hard_grids();
  const GridSubject scene(
      std::find_if(grids.begin(), grids.end(), [](const auto& g) { return g.name == "smooth"; })->grid);
  const ValueRange range = scene.grid.scalar_range;
  const double middle = 0.5 * (range.min + range.max), hair = 1e-4 * (range.max - range.min);
  const double extinction = 3.0 / tests::diagonal_of(scene.grid.bounds);
  OpticalFunction function;
  function.points = {{range.min, 0.0, {0, 0, 1}}, {middle - hair, extinction, {0, 1, 0}}};
  constexpr int kPoints = 3000;
  for (int i = 0; i < kPoints; ++i)
    function.points.push_back(
        {middle - hair + 2 * hair * i / kPoints, extinction * (i % 7) / 6, {1, 0.1 * (i % 5), 0}});
  function.points.push_back({range.max, extinction, {1, 1, 1}});
  Pair pair(scene.grid);
  pair.set_transfer_function(function);
  for (const Integrator integrator : {Integrator::kPost, Integrator::kPre, Integrator::kAntiderivative})
    for (const FilterKind filter : {FilterKind::kLinear, FilterKind::kNearest}) {
      RenderSettings settings = tests::make_settings(integrator, 40, 30);
      settings.filter = {filter};
      settings.samples = 40;
      EXPECT_TRUE(tests::images_agree(pair.gl.render(scene.cameras[0].camera, settings),
                                      pair.cpu.render(scene.cameras[0].camera, settings), 3e-3, 3e-4))
          << text_of(settings.filter, integrator, 0.0);
    }
}

}  // namespace
}  // namespace tetravox::conformance
