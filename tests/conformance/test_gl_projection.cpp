/// Projected cells against exact pictures: sources x orders x integrators x data.

#include "tests/common/gl.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/scenes.h"
#include "tests/reference/integrator.h"
#include "tetravox/error.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace tetravox::conformance {
namespace {

/// Half an 8-bit step, as on the CPU.
::testing::AssertionResult is_exact(const Image& image, const Image& expected) {
  return tests::images_agree(image, expected, 2e-3, 2e-4);
}

/// Of what triangles carry: exact but for the rasterizer's steps, a 512th of a pixel.
constexpr double kMostByTriangles = 5e-2, kRmsByTriangles = 2e-3;

Subject make_any_subject(const std::string& name) {
  return name == "cell_data" ? make_subject(make_cell_data_mesh()) : make_subject(name);
}

RenderSettings make_settings(Source source, CellSort sort, Integrator integrator = Integrator::kAntiderivative) {
  RenderSettings settings = tests::make_settings(integrator, 80, 60);
  settings.source = source;
  settings.projection.sort = sort;
  return settings;
}

class GlProjection : public ::testing::TestWithParam<std::string> {};

TEST_P(GlProjection, PicturesAreExact) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_any_subject(GetParam());
  const reference::Tetrahedra tetrahedra = reference::make_tetrahedra(scene.dataset.mesh);
  Renderer renderer = make_gl_renderer(scene.mesh);
  for (const auto& [camera_name, camera] : scene.cameras)
    for (const auto& [function_name, function] : scene.functions) {
      const Image expected = reference::draw(tetrahedra, function, {camera, 80, 60});
      renderer.set_transfer_function(function);
      for (const Source source : {Source::kProject, Source::kVicp})
        for (const Integrator integrator : tests::kExactIntegrators)
          for (const CellSort sort : {CellSort::kXmpvo, CellSort::kExact}) {
            RenderStatistics drawn;
            const Image image = renderer.render(camera, make_settings(source, sort, integrator), &drawn);
            const std::string where = camera_name + " " + function_name + " " + name_of(source) + " " +
                                      name_of(integrator) + " " + name_of(sort);
            EXPECT_TRUE(tests::is_valid_picture(image)) << where;
            EXPECT_TRUE(is_exact(image, expected)) << where;
            EXPECT_GT(drawn.segments, drawn.rays) << where;
            EXPECT_EQ(drawn.projection.broken_relations, 0u) << where;
          }
    }
}

TEST_P(GlProjection, TheDeviceCutsCellsAsTheCpuDoes) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_any_subject(GetParam());
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(scene.function("smooth"));
  for (const auto& [camera_name, camera] : scene.cameras)
    for (const bool use_pixel_correction : {true, false}) {
      RenderStatistics by_cpu, by_gpu;
      RenderSettings settings = make_settings(Source::kProject, CellSort::kXmpvo);
      settings.projection.use_pixel_correction = use_pixel_correction;
      const Image expected = renderer.render(camera, settings, &by_cpu);
      settings.projection.decomposition = Decomposition::kGpu;
      // Thick vertices half-way between two steps may go to either.
      const double max = use_pixel_correction ? 1e-3 : kMostByTriangles,
                   rms = use_pixel_correction ? 1e-4 : kRmsByTriangles;
      EXPECT_TRUE(tests::images_agree(renderer.render(camera, settings, &by_gpu), expected, max, rms)) << camera_name;
      EXPECT_EQ(by_gpu.projection.cells_at_eye, by_cpu.projection.cells_at_eye) << camera_name;
    }
}

TEST_P(GlProjection, KeptAndSentMeshesGiveTheSamePicture) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_any_subject(GetParam());
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(scene.function("smooth"));
  for (const auto& [camera_name, camera] : scene.cameras) {
    RenderSettings settings = make_settings(Source::kVicp, CellSort::kXmpvo);
    const Image expected = renderer.render(camera, settings);
    settings.projection.transfer = MeshTransfer::kCells;
    EXPECT_TRUE(tests::images_agree(renderer.render(camera, settings), expected, 1e-3)) << camera_name;
  }
}

/// What triangles carry is exact but for the rasterizer's steps: a 512th of a pixel, which counts at the edge of
/// something thick.
TEST_P(GlProjection, TrianglesCarryTheirSegments) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_any_subject(GetParam());
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(scene.function("smooth"));
  for (const auto& [camera_name, camera] : scene.cameras)
    for (const CellSort sort : {CellSort::kXmpvo, CellSort::kExact}) {
      RenderSettings settings = make_settings(Source::kProject, sort);
      const Image expected = renderer.render(camera, settings);
      settings.projection.use_pixel_correction = false;
      EXPECT_TRUE(tests::images_agree(renderer.render(camera, settings), expected, kMostByTriangles, kRmsByTriangles))
          << camera_name << " " << name_of(sort);
    }
}

/// With one extinction and colour everywhere, no order and no interpolation of scalars plays a part: only whether each
/// pixel is covered once by the length of its ray.
TEST_P(GlProjection, EveryPixelIsCoveredOnce) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_any_subject(GetParam());
  const double length = tests::diagonal_of(scene.mesh.bounds);
  const OpticalFunction constant{{{0.0, 2.0 / length, {1.0, 0.5, 0.25}}}};
  const reference::Tetrahedra tetrahedra = reference::make_tetrahedra(scene.dataset.mesh);
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(constant);
  for (const auto& [camera_name, camera] : scene.cameras) {
    const Image expected = reference::draw(tetrahedra, constant, {camera, 80, 60});
    for (const Source source : {Source::kProject, Source::kVicp}) {
      const Image image = renderer.render(camera, make_settings(source, CellSort::kCentroid));
      EXPECT_TRUE(tests::images_agree(image, expected, 2e-3, 2e-4)) << camera_name << " " << name_of(source);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Data, GlProjection,
                         ::testing::Values("sphere", "buckyball?cells=8000", "duct?cells=4000", "cell_data"),
                         [](const auto& test) { return test.param.substr(0, test.param.find('?')); });

/// Three bars, each before one of the others and behind the other.
MeshData make_cyclic_bars() {
  tests::MeshBuilder builder;
  const double angles[] = {0.0, 2.0944, 4.18879};
  for (int k = 0; k < 3; ++k) {
    const auto at = [&](int i) { return Vector3{std::cos(angles[i % 3]), std::sin(angles[i % 3]), 0.0}; };
    Vector3 a = at(k), b = at(k + 1), along{};
    for (int i = 0; i < 3; ++i) along[i] = b[i] - a[i];
    for (int i = 0; i < 3; ++i) {
      a[i] -= 0.25 * along[i];
      b[i] += 0.25 * along[i];
    }
    const Vector3 side{-0.2 * along[1], 0.2 * along[0], 0.0};
    const auto value = 0.2 + 0.3 * k;
    std::vector<std::uint32_t> ids;
    for (const double sign : {-1.0, 1.0})
      ids.push_back(builder.add_point({a[0] + sign * side[0], a[1] + sign * side[1], -0.6}, value));
    for (const double depth : {0.5, 0.8}) ids.push_back(builder.add_point({b[0], b[1], depth}, value));
    builder.add_cell(CellType::kTetrahedron, ids);
  }
  return builder.build();
}

TEST(GlProjectionOrder, ListsAreRightWhereCellsHideOneAnotherInACircle) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject(make_cyclic_bars());
  const OpticalFunction function{
      {{0.2, 8.0, {1, 0, 0}}, {0.35, 8.0, {0, 1, 0}}, {0.5, 8.0, {0, 1, 0}}, {0.8, 8.0, {0, 0, 1}}}};
  Camera camera;
  camera.position = {0.1, 0.05, -6};
  camera.focal_point = {0, 0, 0};
  camera.view_up = {0, 1, 0};
  const Image expected = reference::draw(reference::make_tetrahedra(scene.dataset.mesh), function, {camera, 80, 60});
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(function);
  for (const Source source : {Source::kProject, Source::kVicp}) {
    EXPECT_TRUE(is_exact(renderer.render(camera, make_settings(source, CellSort::kExact)), expected));
    RenderStatistics drawn;
    const Image sorted = renderer.render(camera, make_settings(source, CellSort::kXmpvo), &drawn);
    EXPECT_EQ(drawn.projection.cycles, 1u);
    EXPECT_EQ(drawn.projection.cyclic_cells, 3u);
    EXPECT_GE(drawn.projection.broken_relations, 1u);
    EXPECT_GT(tests::compare_images(sorted, expected).max, 0.1);  // no order of whole cells is right
  }
}

/// Front to back: `extinction` times `length` of a medium of one colour.
void add_layer(double extinction, const std::array<double, 3>& emission, double length, std::array<double, 4>& sum) {
  const double passed = std::exp(-extinction * length);
  for (std::size_t c = 0; c < 3; ++c) sum[c] += (1.0 - sum[3]) * emission[c] / extinction * (1.0 - passed);
  sum[3] = 1.0 - (1.0 - sum[3]) * passed;
}

/// Two boxes that share a part: in it both absorb and emit.
TEST(GlProjectionOrder, WhereCellsIntersectBothAreThere) {
  TETRAVOX_REQUIRE_GL();
  tests::MeshBuilder builder;
  tests::add_box(builder, {.bricks = {2, 2, 2}, .lower = {-1, -1, -1}, .upper = {1, 1, 0.3}, .is_hole = {}},
                 [](const Vector3&) { return 0.25; });
  tests::add_box(builder, {.bricks = {3, 3, 3}, .lower = {-1.1, -1.1, -0.4}, .upper = {1.2, 1.1, 1}, .is_hole = {}},
                 [](const Vector3&) { return 0.75; });
  const Subject scene = make_subject(builder.build());
  const OpticalFunction function{
      {{0.2, 0.5, {1, 0.2, 0}}, {0.3, 0.5, {1, 0.2, 0}}, {0.7, 0.8, {0, 0.3, 1}}, {0.8, 0.8, {0, 0.3, 1}}}};
  std::array<double, 4> expected{};
  add_layer(0.8, {0.0, 0.24, 0.8}, 0.7, expected);
  add_layer(1.3, {0.5, 0.34, 0.8}, 0.7, expected);
  add_layer(0.5, {0.5, 0.1, 0.0}, 0.6, expected);
  const Camera camera{{0.1, 0.05, 5}, {0.1, 0.05, 0}, {0, 1, 0}, 30.0, 0.5};
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(function);
  for (const Source source : {Source::kProject, Source::kVicp}) {
    const Image image = renderer.render(camera, make_settings(source, CellSort::kExact));
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      ASSERT_NEAR(image.pixels[i], expected[i % 4], 1e-3) << name_of(source) << " pixel " << i / 4;
  }
}

TEST(GlProjectionOrder, ConvexMeshesNeedNoMoreThanMpvo) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject("sphere");
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(scene.function("thick"));
  for (const Source source : {Source::kProject, Source::kVicp}) {
    const Image expected = renderer.render(scene.camera("outside"), make_settings(source, CellSort::kXmpvo));
    for (const CellSort sort : {CellSort::kMpvo, CellSort::kMpvonc})
      EXPECT_TRUE(
          tests::images_agree(renderer.render(scene.camera("outside"), make_settings(source, sort)), expected, 1e-4))
          << name_of(sort);
  }
}

TEST(GlProjectionOrder, LongListsAreDrawnInBands) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject("buckyball?cells=100000");
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(scene.function("smooth"));
  RenderSettings settings = make_settings(Source::kVicp, CellSort::kXmpvo);
  settings.width = 560;
  settings.height = 420;
  RenderStatistics drawn;
  const Image expected = renderer.render(scene.camera("inside"), settings, &drawn);
  EXPECT_GT(drawn.segments, 7'000'000u);  // more than fit at once where 128 MiB are allowed
  settings.projection.sort = CellSort::kExact;
  EXPECT_TRUE(tests::images_agree(renderer.render(scene.camera("inside"), settings), expected, 1e-3));
}

TEST(GlProjectionOrder, DegenerateAndOverlappingCellsDoNoHarm) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject(tests::make_soup(300, 5));
  Renderer renderer = make_gl_renderer(scene.mesh);
  renderer.set_transfer_function(scene.function("random"));
  for (const auto& [camera_name, camera] : scene.cameras)
    for (const Source source : {Source::kProject, Source::kVicp})
      for (const auto& [sort, description] : cell_sort_names()) {
        const Image image = renderer.render(camera, make_settings(source, cell_sort_from_name(sort)));
        EXPECT_TRUE(tests::is_valid_picture(image)) << camera_name << " " << name_of(source) << " " << sort;
      }
}

TEST(GlProjectionOrder, TheCpuRefusesByName) {
  const Subject scene = make_subject("sphere");
  Renderer renderer(scene.mesh);
  renderer.set_transfer_function(scene.function("smooth"));
  for (const Source source : {Source::kProject, Source::kVicp}) {
    try {
      renderer.render(scene.camera("outside"), make_settings(source, CellSort::kXmpvo));
      FAIL() << "drawn";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_NE(std::string(error.what()).find(name_of(source)), std::string::npos);
    }
  }
}

/// Pixels of a comb of many plates have longer lists than are sorted at once.
TEST(GlProjection, ListsMayBeLong) {
  TETRAVOX_REQUIRE_GL();
  const Subject scene = make_subject(make_comb(700));
  Renderer gl = make_gl_renderer(scene.mesh), cpu(scene.mesh);
  gl.set_transfer_function(scene.function("smooth"));
  cpu.set_transfer_function(scene.function("smooth"));
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 16, 12);
  settings.use_early_ray_termination = false;
  RenderStatistics drawn, expected;
  const Image same = cpu.render(kAlongComb, settings, &expected);
  settings.source = Source::kProject;
  settings.projection.sort = CellSort::kExact;
  EXPECT_TRUE(tests::images_agree(gl.render(kAlongComb, settings, &drawn), same, 2e-4));
  EXPECT_GT(drawn.segments, 1000 * drawn.rays) << "the lists are long";
}

}  // namespace
}  // namespace tetravox::conformance
