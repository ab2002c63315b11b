/// The integrators that look ray integrals up in tables: the same bytes everywhere, errors that fall as tables grow.

#include "tests/common/image_compare.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/conformance/scenes.h"
#include "tetravox/error.h"

#include <cmath>
#include <iostream>

namespace tetravox::conformance {
namespace {

constexpr Integrator kTableIntegrators[] = {Integrator::kTable3d, Integrator::kPolynomial, Integrator::kCylindrical};

RenderSettings make_table_settings(Integrator integrator, int width = 96, int height = 72) {
  RenderSettings settings = tests::make_settings(integrator, width, height);
  settings.preintegration.scalars = 40;
  settings.preintegration.lengths = 24;
  settings.preintegration.planes = 17;
  settings.preintegration.tile = 24;
  settings.preintegration.steps = 8;
  return settings;
}

double rms_between(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    sum += std::pow(static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

/// Draws the same bytes with every instruction set and number of threads.
template <class Prepared>
void expect_the_same_bytes(const Prepared& prepared, const OpticalFunction& function, const Camera& camera,
                           RenderSettings settings, const std::string& where) {
  Renderer renderer(prepared);
  renderer.set_transfer_function(function);
  settings.threads = 1;
  const Image first = renderer.render(camera, settings);
  // Highlights are brighter than what they lie on is opaque.
  EXPECT_TRUE(settings.lighting.is_lit() || tests::is_valid_picture(first)) << where;
  EXPECT_GT(tests::count_covered(first), 0u) << where;
  for (const std::string& instruction_set : instruction_sets())
    for (const int threads : {1, 3, 0}) {
      settings.instruction_set = instruction_set;
      settings.threads = threads;
      EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings), first))
          << where << " " << instruction_set << ", threads " << threads;
      Renderer another(prepared);
      another.set_transfer_function(function);
      EXPECT_TRUE(tests::images_equal(another.render(camera, settings), first))
          << where << " " << instruction_set << ", tables by " << threads << " threads";
    }
}

TEST(Preintegration, MeshesGiveTheSameBytesEverywhere) {
  for (const char* builtin : {"sphere", "duct?cells=4000"}) {
    const Subject scene = make_subject(builtin);
    for (const auto& [camera_name, camera] : scene.cameras)
      for (const Integrator integrator : kTableIntegrators)
        expect_the_same_bytes(scene.mesh, scene.function("steps"), camera, make_table_settings(integrator),
                              std::string(builtin) + " " + camera_name + " " + name_of(integrator));
  }
}

TEST(Preintegration, GridsGiveTheSameBytesEverywhere) {
  for (const NamedGrid& named : make_hard_grids()) {
    const GridSubject scene(named.grid);
    for (const Integrator integrator : {Integrator::kTable3d, Integrator::kPolynomial})
      for (const double rate : {0.0, 1.5}) {
        RenderSettings settings = make_table_settings(integrator);
        settings.samples_per_voxel = rate;
        expect_the_same_bytes(scene.grid, scene.function("random"), scene.camera("outside"), settings,
                              std::string(named.name) + " " + name_of(integrator) + " " + std::to_string(rate));
      }
  }
}

TEST(Preintegration, LightAndSurfacesGiveTheSameBytesEverywhere) {
  const Subject scene = make_subject("duct?cells=4000");
  const GridSubject grid(make_hard_grids().front().grid);
  for (const Integrator integrator : kTableIntegrators) {
    RenderSettings settings = make_table_settings(integrator, 64, 48);
    settings.lighting.lights = {Light{}};
    const auto with_surface = [&](const ValueRange& range) {
      settings.surfaces.resize(1);
      settings.surfaces[0].value = 0.4 * range.min + 0.6 * range.max;
      settings.surfaces[0].opacity = 0.5;
      return settings;
    };
    expect_the_same_bytes(scene.mesh, scene.function("smooth"), scene.camera("outside"),
                          with_surface(scene.mesh.scalar_range), name_of(integrator) + " mesh");
    if (integrator != Integrator::kCylindrical)
      expect_the_same_bytes(grid.grid, grid.function("smooth"), grid.camera("outside"),
                            with_surface(grid.grid.scalar_range), name_of(integrator) + " grid");
  }
}

/// Errors against `partial`, in the order of the settings.
template <class Scene, class Prepared>
std::vector<double> measure(const Scene& scene, const Prepared& prepared, const std::string& function,
                            const std::vector<RenderSettings>& all, bool is_lit = false) {
  std::vector<double> errors;
  for (RenderSettings settings : all) {
    settings.use_early_ray_termination = false;
    settings.tolerance = 1e-4;
    if (is_lit) settings.lighting.lights = {Light{}};
    const Image image = render(prepared, scene.function(function), scene.camera("outside"), settings);
    settings.integrator = Integrator::kPartial;
    errors.push_back(rms_between(image, render(prepared, scene.function(function), scene.camera("outside"), settings)));
  }
  return errors;
}

/// Tables of growing sizes: each twice as fine as the last one.
std::vector<RenderSettings> make_growing(Integrator integrator, int count) {
  std::vector<RenderSettings> all;
  for (int i = 0; i < count; ++i) {
    RenderSettings settings = make_table_settings(integrator);
    settings.preintegration.scalars = 40 << i;  // no size has its entries at the points of the random function
    settings.preintegration.lengths = 16 << i;
    settings.preintegration.planes = (16 << i) + 1;
    settings.preintegration.tile = 40 << i;
    settings.preintegration.degree = 4;
    settings.preintegration.steps = 16;
    all.push_back(settings);
  }
  return all;
}

void expect_to_fall(const std::vector<double>& errors, double factor, const std::string& where) {
  std::cout << where << ": RMS";
  for (const double error : errors) std::cout << " " << error;
  std::cout << "\n";
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], factor * errors[i - 1]) << where << " " << i;
}

TEST(Preintegration, ErrorsOfMeshesFallAsTablesGrow) {
  for (const char* builtin : {"sphere", "buckyball?cells=20000"}) {
    const Subject scene = make_subject(builtin);
    for (const char* function : {"smooth", "steps", "random"})
      for (const Integrator integrator : kTableIntegrators)
        expect_to_fall(measure(scene, scene.mesh, function, make_growing(integrator, 3)), 0.8,
                       std::string(builtin) + " " + function + " " + name_of(integrator));
  }
}

TEST(Preintegration, ErrorsOfGridsFallAsTablesGrow) {
  const GridSubject scene(make_hard_grids().front().grid);
  for (const char* function : {"smooth", "steps", "random"})
    for (const Integrator integrator : {Integrator::kTable3d, Integrator::kPolynomial})
      for (const bool is_lit : {false, true})
        expect_to_fall(measure(scene, scene.grid, function, make_growing(integrator, 3), is_lit), 0.8,
                       std::string(function) + " " + name_of(integrator) + (is_lit ? ", lit" : ""));
}

TEST(Preintegration, HigherDegreesAreBetter) {
  std::vector<RenderSettings> degrees;
  for (const int degree : {0, 1, 2, 4}) {
    degrees.push_back(make_table_settings(Integrator::kPolynomial));
    degrees.back().preintegration.scalars = 512;
    degrees.back().preintegration.degree = degree;
  }
  const Subject sphere = make_subject("sphere");
  expect_to_fall(measure(sphere, sphere.mesh, "thick", degrees), 1.0, "mesh");
  const GridSubject grid(make_hard_grids().front().grid);
  expect_to_fall(measure(grid, grid.grid, "thick", degrees), 1.0, "grid");
}

TEST(Preintegration, CellDataIsExact) {
  const Subject mesh = make_subject(make_cell_data_mesh());
  for (const Integrator integrator : kTableIntegrators)
    EXPECT_EQ(measure(mesh, mesh.mesh, "steps", {make_table_settings(integrator)}).front(), 0.0);
  for (const NamedGrid& named : make_hard_grids()) {
    if (std::string(named.name) != "cell_data") continue;
    const GridSubject grid(named.grid);
    EXPECT_EQ(measure(grid, grid.grid, "steps", {make_table_settings(Integrator::kTable3d)}).front(), 0.0);
  }
}

TEST(Preintegration, CylindricalIsForMeshes) {
  const GridSubject scene(make_hard_grids().front().grid);
  try {
    render(scene.grid, scene.function("smooth"), scene.camera("outside"),
           make_table_settings(Integrator::kCylindrical));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
    EXPECT_NE(std::string(error.what()).find("cylindrical is for meshes"), std::string::npos);
  }
}

}  // namespace
}  // namespace tetravox::conformance
