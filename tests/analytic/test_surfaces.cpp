/// Iso-surfaces in closed form: spheres in the field of a distance, sheets in linear fields, no holes.

#include "tests/analytic/cube.h"
#include "tests/analytic/light_model.h"
#include "tests/analytic/show.h"
#include "tests/common/grid_builder.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::analytic {
namespace {

const OpticalFunction kNothing{{{0.0, 0.0, {0, 0, 0}}}};

/// Grids and meshes of [-1, 1]^3.
class Surfaces : public ::testing::TestWithParam<bool> {
 protected:
  static bool is_grid() { return GetParam(); }
  static tests::Body cube(int cells, const tests::Field& field) { return make_cube(is_grid(), cells, field); }
  static RenderSettings make_settings(int width, int height) {
    RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, width, height);
    settings.tolerance = 1e-4;
    settings.use_early_ray_termination = false;
    return settings;
  }
};

/// The nearest place of a ray on a sphere around the origin that lies before the eye.
std::optional<double> hit_sphere(const Ray& ray, double radius) {
  const double nearest = -dot(ray.origin, ray.direction);
  const double rest = radius * radius - (dot(ray.origin, ray.origin) - nearest * nearest);
  if (rest < 0.0) return std::nullopt;
  const double half = std::sqrt(rest);
  if (nearest - half > 0.0) return nearest - half;
  if (nearest + half > 0.0) return nearest + half;
  return std::nullopt;
}

double axial_depth(const Camera& camera, const Ray& ray, double t) {
  const Vector3 view = normalized(difference(camera.focal_point, camera.position));
  return dot(difference(ray.at(t), camera.position), view);
}

/// How far the surface of a linear interpolant of |p| may lie inside that of |p|: |p| is convex, its second derivative
/// 1 / r across the radius. In a cube the error is at most h^2 / 8 times the sum of those along its axes; in a
/// tetrahedron half the square of the radius about its corners times the largest.
double shift_of(bool is_grid, int cells, double radius) {
  const double step = 2.0 / cells, nearest = radius - step;
  return is_grid ? step * step / (4.0 * nearest) : 3.0 * step * step / (8.0 * nearest);
}

constexpr double kRadius = 0.7;

TEST_P(Surfaces, SphereIsAtItsDepthWithoutHoles) {
  for (const int cells : {16, 63}) {
    if (!is_grid() && cells > 40) continue;
    const tests::Body body = cube(cells, norm);
    RenderSettings settings = make_settings(101, 83);
    settings.surfaces = {{kRadius, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 1.0, true}};
    settings.wants_depth = true;
    const double inner = kRadius - shift_of(is_grid(), cells, kRadius);
    for (const auto& [name, camera] : standard_cameras()) {
      const Image image = body.draw(kNothing, camera, settings);
      ASSERT_EQ(image.depth.size(), 101u * 83u);
      const bool is_inside = norm(camera.position) < inner;
      int covered = 0;
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          SCOPED_TRACE(std::string(name) + " pixel " + std::to_string(x) + ", " + std::to_string(y));
          const Ray ray = make_ray(camera, image.width, image.height, x, y);
          const float* pixel = image.pixel(x, y);
          const double depth = image.depth[static_cast<std::size_t>(y * image.width + x)];
          const std::optional<double> outer_hit = hit_sphere(ray, kRadius), inner_hit = hit_sphere(ray, inner);
          if (!outer_hit) {
            ASSERT_EQ(pixel[3], 0.0f);
            ASSERT_EQ(depth, std::numeric_limits<double>::infinity());
          }
          if (!inner_hit) continue;
          ++covered;
          ASSERT_GT(pixel[3], 1.0f - 1e-4f);
          // From outside the field falls along the ray: the back is seen.
          const Color color = is_inside ? settings.surfaces[0].front_color : settings.surfaces[0].back_color;
          for (int k = 0; k < 3; ++k) ASSERT_NEAR(pixel[k], color[k], 1e-5);
          const auto [near, far] = std::minmax(*outer_hit, *inner_hit);
          ASSERT_GE(depth, axial_depth(camera, ray, near) - 1e-5);
          ASSERT_LE(depth, axial_depth(camera, ray, far) + 1e-5);
        }
      EXPECT_GT(covered, 600) << name;
    }
  }
}

/// Largest difference between the lit sphere and its closed form, a border of its silhouette left out.
double lit_sphere_error(const tests::Body& body, const Camera& camera, const RenderSettings& settings) {
  const Image image = body.draw(kNothing, camera, settings);
  const bool is_inside = norm(camera.position) < kRadius;
  const Isosurface& surface = settings.surfaces[0];
  double worst = 0.0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = make_ray(camera, image.width, image.height, x, y);
      const std::optional<double> hit = hit_sphere(ray, kRadius);
      if (!hit || !hit_sphere(ray, 0.95 * kRadius)) continue;
      const Vector3 place = ray.at(*hit);
      const Color color = is_inside ? surface.front_color : surface.back_color;
      const Color wanted = illuminate(settings.lighting, ray.direction, place, place, 1.0).apply(color);
      for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(image.pixel(x, y)[k] - wanted[k]));
    }
  return worst;
}

TEST_P(Surfaces, LitSphereHasItsClosedForm) {
  for (const bool is_two_sided : {true, false}) {
    RenderSettings settings = make_settings(81, 63);
    settings.surfaces = {{kRadius, {0.7, 0.5, 0.3}, {0.3, 0.6, 0.8}, 1.0, true}};
    settings.lighting = make_lights();
    settings.lighting.is_two_sided = is_two_sided;
    for (const auto& [name, camera] : standard_cameras()) {
      const double coarse = lit_sphere_error(cube(12, norm), camera, settings);
      const double fine = lit_sphere_error(cube(is_grid() ? 48 : 36, norm), camera, settings);
      EXPECT_LT(coarse, 0.2) << name;
      EXPECT_LT(fine, 0.02) << name;
      EXPECT_LT(fine, coarse / 3.0) << name;
    }
  }
}

TEST_P(Surfaces, OneSidedSurfacesAreSeenWhereTheFieldRises) {
  const tests::Body body = cube(16, norm);
  RenderSettings settings = make_settings(41, 33);
  settings.surfaces = {{kRadius, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.6, false}};
  const double inner = kRadius - shift_of(is_grid(), 16, kRadius);
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = body.draw(kNothing, camera, settings);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        if (!hit_sphere(make_ray(camera, image.width, image.height, x, y), inner)) continue;
        ASSERT_NEAR(image.pixel(x, y)[3], 0.6f, 1e-5f) << name;  // not the front sheet, but the far one
        ASSERT_NEAR(image.pixel(x, y)[0], 0.54f, 1e-5f) << name;
      }
  }
}

/// No transparent pixel among eight that are covered.
void expect_no_pin_holes(const Image& image, const std::string& name) {
  int covered = 0;
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1; x + 1 < image.width; ++x) {
      int around = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          if (i != 0 || j != 0) around += image.pixel(x + i, y + j)[3] > 0.999f;
      covered += image.pixel(x, y)[3] > 0.999f;
      EXPECT_TRUE(around < 8 || image.pixel(x, y)[3] > 0.999f) << name << " pixel " << x << ", " << y;
    }
  EXPECT_GT(covered, image.width * image.height / 20) << name;
}

TEST_P(Surfaces, SmoothFieldsHaveNoPinHoles) {
  // A ball with waves on it: closed, so that every ray through its middle meets it.
  const tests::Field waves = tests::make_random_field(5, 2.0);
  const tests::Body body = cube(is_grid() ? 37 : 18, [&](const Vector3& p) { return norm(p) + 0.25 * waves(p); });
  std::mt19937 random(3);
  const auto draw = [&] { return 2.0 * (static_cast<double>(random()) / 4294967296.0) - 1.0; };
  for (int round = 0; round < 40; ++round) {
    Camera camera;
    const Vector3 towards{draw(), draw(), draw()};
    camera.position = scaled(normalized(towards), 2.0 + 1.5 * std::abs(draw()));
    if (round % 8 == 7) camera.position = scaled({0, 0, 1}, 3.0);  // along the lattice
    camera.view_up = {draw(), draw(), draw()};
    if (round % 4 == 3) camera.parallel_scale = 0.9;
    RenderSettings settings = make_settings(160, 120);
    settings.surfaces = {{0.75, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 1.0, true}};
    expect_no_pin_holes(body.draw(kNothing, camera, settings), "round " + std::to_string(round));
  }
}

/// s = offset + slope . p.
struct LinearField {
  double offset = 0.0;
  Vector3 slope{};

  double operator()(const Vector3& p) const { return offset + dot(slope, p); }
};

/// Sheets in a linear field between which the volume has constant colour and linear extinction.
Rgba composite_sheets(const LinearField& field, const std::vector<Isosurface>& surfaces, const Lighting& lighting,
                      const OpticalFunction& function, const Ray& ray) {
  const Chord chord = intersect_box(ray, kLower, kUpper);
  if (chord.length() == 0.0) return {};
  const double rate = dot(field.slope, ray.direction), at_eye = field(ray.origin);
  std::vector<std::pair<double, const Isosurface*>> met;
  for (const Isosurface& surface : surfaces) {
    const double t = (surface.value - at_eye) / rate;
    if (t > chord.near && t < chord.far) met.push_back({t, &surface});
  }
  std::sort(met.begin(), met.end());
  const auto volume = [&](double from, double to) {
    const OpticalPoint middle = eval_optical_function(function, field(ray.at(0.5 * (from + to))));
    return fill(middle.color, middle.extinction * (to - from));
  };
  Rgba result{};
  double from = chord.near;
  for (const auto& [t, surface] : met) {
    result = over(result, volume(from, t));
    from = t;
    const double opacity = rate > 0.0 || surface->is_two_sided ? surface->opacity : 0.0;
    const Color& color = rate > 0.0 ? surface->front_color : surface->back_color;
    const Color lit =
        lighting.is_lit() ? illuminate(lighting, ray.direction, ray.at(t), field.slope, 1.0).apply(color) : color;
    result = over(result, {opacity * lit[0], opacity * lit[1], opacity * lit[2], opacity});
  }
  return over(result, volume(from, chord.far));
}

const OpticalFunction kRising{{{0.0, 0.2, {0.9, 0.6, 0.3}}, {1.0, 2.4, {0.9, 0.6, 0.3}}}};

std::vector<Isosurface> two_sheets(double first, double second) {
  return {{first, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.4, true}, {second, {0.2, 0.8, 0.1}, {0.6, 0.1, 0.7}, 0.7, true}};
}

TEST_P(Surfaces, SheetsAndVolumeAreCompositedInOrder) {
  const LinearField field{0.5, {0.2, -0.15, 0.1}};
  RenderSettings settings = make_settings(61, 43);
  for (const Integrator integrator : tests::kAllIntegrators) {
    settings.integrator = integrator;
    settings.samples = 256;
    settings.surfaces = two_sheets(0.43, 0.61);
    settings.surfaces.push_back({0.5, {1, 1, 1}, {1, 1, 1}, 0.5, false});
    expect_shown(cube(7, field), kRising, settings,
                 [&](const Ray& ray) { return composite_sheets(field, settings.surfaces, {}, kRising, ray); },
                 {5e-5, 2e-5});
  }
}

/// Rays travel side by side: those that meet a surface must not change what the others gather.
TEST(SurfacesInMeshes, RaysThatMeetNoneAreAsWithout) {
  const tests::Body body = make_cube(false, 12, norm);
  const OpticalFunction function{
      {{0.0, 1.5, {0.9, 0.6, 0.3}}, {0.8, 0.2, {0.2, 0.6, 0.9}}, {1.8, 1.1, {0.9, 0.9, 0.1}}}};
  const std::vector<std::string> sets = instruction_sets();
  std::size_t next_set = 0;
  for (const Integrator integrator : tests::kAllIntegrators) {
    RenderSettings settings = tests::make_settings(integrator, 101, 83);
    for (const auto& [name, camera] : standard_cameras()) {
      settings.instruction_set = sets[next_set++ % sets.size()];
      settings.surfaces.clear();
      const Image without = body.draw(function, camera, settings);
      settings.surfaces = {{kRadius, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.5, true}};
      const Image with = body.draw(function, camera, settings);
      int same = 0, other = 0;
      for (int y = 0; y < with.height; ++y)
        for (int x = 0; x < with.width; ++x) {
          const Ray ray = make_ray(camera, with.width, with.height, x, y);
          const bool is_same = std::equal(with.pixel(x, y), with.pixel(x, y) + 4, without.pixel(x, y));
          if (!hit_sphere(ray, kRadius)) {
            EXPECT_TRUE(is_same) << name << " " << x << " " << y;
            ++same;
          } else if (!is_same) {
            ++other;
          }
        }
      if (norm(camera.position) > kRadius) {
        EXPECT_GT(same, 1000) << name;
      }
      EXPECT_GT(other, 500) << name;
    }
  }
}

TEST_P(Surfaces, SheetsInTheLatticesPlanesAreMetOnce) {
  // The values are those at planes of points, exactly.
  const LinearField field{0.5, {0.25, 0, 0}};
  RenderSettings settings = make_settings(61, 43);
  settings.surfaces = two_sheets(0.4375, 0.625);
  for (const int cells : {8, 24})
    expect_shown(cube(cells, field), kRising, settings,
                 [&](const Ray& ray) { return composite_sheets(field, settings.surfaces, {}, kRising, ray); },
                 {5e-5, 2e-5});
}

TEST_P(Surfaces, SheetsInDiagonalPlanesOfTheLatticeAreMetOnce) {
  // Planes through points, edges and faces' diagonals.
  const LinearField field{0.5, {0.125, 0.125, 0.125}};
  RenderSettings settings = make_settings(61, 43);
  settings.surfaces = two_sheets(0.4375, 0.625);
  expect_shown(cube(8, field), kRising, settings,
               [&](const Ray& ray) { return composite_sheets(field, settings.surfaces, {}, kRising, ray); },
               {5e-5, 2e-5});
}

TEST_P(Surfaces, SurfacesOfOneValueLieOnEachOther) {
  const LinearField field{0.5, {0.2, -0.15, 0.1}};
  RenderSettings settings = make_settings(61, 43);
  settings.surfaces = two_sheets(0.5, 0.5);
  for (Isosurface& surface : settings.surfaces) surface.front_color = surface.back_color = {0.3, 0.3, 0.3};
  expect_shown(cube(7, field), kNothing, settings,
               [&](const Ray& ray) { return composite_sheets(field, settings.surfaces, {}, kNothing, ray); },
               {5e-5, 2e-5});
}

TEST_P(Surfaces, LitSheetsHaveTheirClosedForm) {
  const LinearField field{0.5, {0.2, -0.15, 0.1}};
  RenderSettings settings = make_settings(61, 43);
  settings.surfaces = two_sheets(0.43, 0.61);
  settings.lighting = make_lights();
  for (const bool is_two_sided : {true, false}) {
    settings.lighting.is_two_sided = is_two_sided;
    expect_shown(
        cube(7, field), kNothing, settings,
        [&](const Ray& ray) { return composite_sheets(field, settings.surfaces, settings.lighting, kNothing, ray); },
        {1e-4, 2e-5});
  }
}

TEST_P(Surfaces, ClippedSurfacesAreMetInsideAlone) {
  const LinearField field{0.5, {0.2, -0.15, 0.1}};
  RenderSettings settings = make_settings(61, 43);
  settings.surfaces = two_sheets(0.43, 0.61);
  const ClipSphere sphere{{0.1, 0, 0.05}, 0.95};
  settings.clipping.shapes = {{sphere, true}};
  expect_shown(cube(7, field), kNothing, settings,
               [&](const Ray& ray) {
                 const double rate = dot(field.slope, ray.direction), at_eye = field(ray.origin);
                 std::vector<Isosurface> met;
                 for (const Isosurface& surface : settings.surfaces) {
                   const Vector3 place = ray.at((surface.value - at_eye) / rate);
                   if (norm(difference(place, sphere.center)) < sphere.radius) met.push_back(surface);
                 }
                 return composite_sheets(field, met, {}, kNothing, ray);
               },
               {5e-5, 2e-5});
}

TEST_P(Surfaces, DepthIsWhereTheVolumesOpacityPassesOneHalf) {
  const OpticalFunction function{{{0.0, 1.7, {1, 1, 1}}}};
  RenderSettings settings = make_settings(61, 43);
  settings.wants_depth = true;
  const tests::Body body = cube(7, [](const Vector3&) { return 0.5; });
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = body.draw(function, camera, settings);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Ray ray = make_ray(camera, image.width, image.height, x, y);
        const Chord chord = intersect_box(ray, kLower, kUpper);
        const double depth = image.depth[static_cast<std::size_t>(y * image.width + x)];
        const double needed = std::log(2.0) / 1.7;
        if (std::abs(chord.length() - needed) < 1e-4) continue;
        if (chord.length() > needed)
          EXPECT_NEAR(depth, axial_depth(camera, ray, chord.near + needed), 2e-5) << name << " " << x << ", " << y;
        else
          EXPECT_EQ(depth, std::numeric_limits<double>::infinity()) << name << " " << x << ", " << y;
      }
  }
}

TEST_P(Surfaces, CellDataHaveNone) {
  tests::GridOptions grid;
  grid.association = Association::kCell;
  tests::BoxOptions mesh;
  mesh.association = Association::kCell;
  const tests::Body body = is_grid() ? tests::Body(tests::make_grid(grid, norm)) : tests::make_box(mesh, norm);
  RenderSettings settings = make_settings(9, 9);
  settings.surfaces = {{}};
  EXPECT_THROW(body.draw(kNothing, standard_cameras()[0].second, settings), Error);
}

TEST(SurfacesBesideMissingValues, AreNumbersWithEveryFilter) {
  tests::GridOptions options;
  const double missing = std::numeric_limits<double>::quiet_NaN();
  const tests::Body body =
      tests::make_grid(options, [&](const Vector3& p) { return p[0] + 0.3 * p[1] > 0.1 ? missing : norm(p); });
  const OpticalFunction function{{{0.0, 0.5, {0.9, 0.5, 0.2}}, {2.0, 2.0, {0.2, 0.5, 0.9}}}};
  for (const FilterKind filter : {FilterKind::kLinear, FilterKind::kBspline, FilterKind::kCatmullRom})
    for (const OpacityWeight weight : {OpacityWeight::kNone, OpacityWeight::kGradient})
      for (const bool is_lit : {false, true}) {
        RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 41, 31);
        settings.filter.kind = filter;
        settings.opacity_weight = weight;
        settings.lighting.gradient = GradientMethod::kFilter;
        if (is_lit) settings.lighting.lights = {Light{}, {LightKind::kDirectional, {1, 2, -1}, {}, {1, 1, 1}, 0.5}};
        settings.surfaces = {{0.8, {0.9, 0.3, 0.2}, {0.3, 0.3, 0.8}, 0.6, true}};
        for (const auto& [name, camera] : standard_cameras()) {
          const Image image = body.draw(function, camera, settings);
          EXPECT_TRUE(std::all_of(image.pixels.begin(), image.pixels.end(), [](float x) { return std::isfinite(x); }))
              << name << " " << name_of(settings.filter) << " " << name_of(weight) << " " << is_lit;
          EXPECT_GT(tests::count_covered(image), 100u) << name;
        }
      }
}

INSTANTIATE_TEST_SUITE_P(All, Surfaces, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "grid" : "mesh"; });

}  // namespace
}  // namespace tetravox::analytic
