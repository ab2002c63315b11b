/// Every integrator for every source that `tetravox list methods` names of OpenGL, beside the CPU's.

#include "tests/common/gl.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/conformance/scenes.h"
#include "tests/conformance/slices.h"
#include "tetravox/slicing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace tetravox::conformance {
namespace {

constexpr Integrator kTables[] = {Integrator::kTable3d, Integrator::kPolynomial};

std::vector<Integrator> integrators_of(Source source) {
  for (const SourceMethods& methods : gl_methods())
    if (methods.source == source) return methods.integrators;
  ADD_FAILURE() << name_of(source) << " draws nothing";
  return {};
}

GridData grid_named(const std::string& name) {
  const std::vector<NamedGrid> grids = make_hard_grids();
  return std::find_if(grids.begin(), grids.end(), [&](const auto& g) { return g.name == name; })->grid;
}

/// A cell that is a segment is one for every source: the same look-ups, in another order.
TEST(GlIntegrators, OfProjectedCellsAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  // Devices may interpolate between texels of tables in steps of 1/256.
  const bool is_exact = gl_devices().front().is_software;
  for (const char* mesh : {"sphere", "buckyball?cells=8000"}) {
    const Subject scene = make_subject(mesh);
    Renderer gl = make_gl_renderer(scene.mesh), cpu(scene.mesh);
    for (const char* function : {"smooth", "spikes"}) {
      gl.set_transfer_function(scene.function(function));
      cpu.set_transfer_function(scene.function(function));
      for (const Source source : {Source::kWalk, Source::kProject, Source::kVicp})
        for (const Integrator integrator : integrators_of(source))
          for (const char* camera : {"outside", "orthographic", "inside"}) {
            RenderSettings settings = tests::make_settings(integrator, 64, 48);
            settings.use_early_ray_termination = false;
            settings.preintegration.scalars = settings.preintegration.planes = 33;
            settings.preintegration.lengths = settings.preintegration.tile = 16;
            const Image expected = cpu.render(scene.camera(camera), settings);
            settings.source = source;
            RenderStatistics drawn;
            const Image image = gl.render(scene.camera(camera), settings, &drawn);
            const std::string where =
                std::string(mesh) + " " + function + " " + camera + " " + name_of(source) + " " + name_of(integrator);
            EXPECT_TRUE(tests::is_valid_picture(image)) << where;
            EXPECT_TRUE(tests::images_agree(image, expected, is_exact ? 2e-3 : 1e-2, is_exact ? 2e-4 : 1e-3)) << where;
            EXPECT_EQ(drawn.integrator, name_of(integrator));
          }
    }
  }
}

/// How far the pictures of two backends may be apart, and pictures by tables from those by integrals.
constexpr double kMostApart = 3e-3, kMostApartRms = 3e-4;
/// At a fixed rate the last sample of a ray is there or not: so many pixels of a thousand may differ by more.
constexpr int kApartOfThousand = 10;

RenderSettings table_settings(Integrator integrator) {
  RenderSettings settings = tests::make_settings(integrator, 64, 48);
  settings.use_early_ray_termination = false;
  return settings;
}

void expect_same_tables(const std::string& name, double samples_per_voxel) {
  const GridSubject scene(grid_named(name));
  Renderer gl = make_gl_renderer(scene.grid), cpu(scene.grid);
  for (const char* function : {"smooth", "random"}) {
    gl.set_transfer_function(scene.function(function));
    cpu.set_transfer_function(scene.function(function));
    for (const Integrator integrator : kTables)
      for (const auto& [camera_name, camera] : scene.cameras) {
        RenderSettings settings = table_settings(integrator);
        settings.samples_per_voxel = samples_per_voxel;
        const Image image = gl.render(camera, settings), expected = cpu.render(camera, settings);
        const std::string where = name + " " + function + " " + camera_name + " " + name_of(integrator);
        EXPECT_TRUE(tests::is_valid_picture(image)) << where;
        if (samples_per_voxel > 0.0)
          EXPECT_LE(1000 * tests::count_apart(image, expected, kMostApart),
                    kApartOfThousand * image.width * image.height)
              << where;
        else
          EXPECT_TRUE(tests::images_agree(image, expected, kMostApart, kMostApartRms)) << where;
      }
  }
}

TEST(GlIntegrators, TablesOfGridsAreThoseOfTheCpu) {
  TETRAVOX_REQUIRE_GL();
  for (const char* grid : {"smooth", "bytes", "uneven", "cell_data"}) expect_same_tables(grid, 0.0);
}

/// The longest segment of a table follows the rate: below a voxel, and above it.
TEST(GlIntegrators, TablesOfGridsKeepTheRate) {
  TETRAVOX_REQUIRE_GL();
  for (const double rate : {0.4, 2.0}) expect_same_tables("smooth", rate);
}

/// The same slabs, looked up instead of integrated: as near as tables are, however thick slabs are. A few of them are
/// longer than the diagonal of a cell.
TEST(GlIntegrators, TablesOfSlabsAreAsGoodAsTables) {
  TETRAVOX_REQUIRE_GL();
  const GridSubject scene(grid_named("smooth"));
  Renderer gl = make_gl_renderer(scene.grid);
  gl.set_transfer_function(scene.function("smooth"));
  constexpr int kFew = 6, kMany = 120;
  for (const SlicingKind kind :
       {SlicingKind::kObject2dInterpolated, SlicingKind::kStripes2d, SlicingKind::kView3d, SlicingKind::kShells})
    for (const SlabShape shape : {SlabShape::kLinear, SlabShape::kCurved})
      for (const int slices : {kFew, kMany})
        for (const Integrator integrator : {Integrator::kPartial, Integrator::kTable3d, Integrator::kPolynomial}) {
          RenderSettings settings = slices_of(kind, slices);
          settings.slicing.slabs = shape;
          const Image expected = gl.render(scene.camera("outside"), settings);
          settings.integrator = integrator;
          settings.preintegration.degree = 4;
          const Image image = gl.render(scene.camera("outside"), settings);
          const std::string where =
              name_of(kind) + " " + name_of(shape) + " " + std::to_string(slices) + " " + name_of(integrator);
          EXPECT_TRUE(tests::is_valid_picture(image)) << where;
          EXPECT_TRUE(tests::images_agree(image, expected, kMostApart, kMostApartRms)) << where;
        }
}

}  // namespace
}  // namespace tetravox::conformance
