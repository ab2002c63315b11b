/// Clipped bodies in closed form: planes, boxes, spheres, volumes, and what several of them leave.

#include "tests/analytic/cube.h"
#include "tests/analytic/light_model.h"
#include "tests/analytic/show.h"
#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::analytic {
namespace {

bool contains(const ClipPlane& plane, const Vector3& p) { return dot(difference(p, plane.origin), plane.normal) >= 0; }
bool contains(const ClipBox& box, const Vector3& p) {
  bool is_inside = true;
  for (int axis = 0; axis < 3; ++axis)
    is_inside = is_inside && p[axis] >= box.bounds[axis].min && p[axis] <= box.bounds[axis].max;
  return is_inside;
}
bool contains(const ClipSphere& sphere, const Vector3& p) {
  const Vector3 offset = difference(p, sphere.center);
  return dot(offset, offset) <= sphere.radius * sphere.radius;
}
bool contains(const ClipVolume&, const Vector3&) { return false; }

/// Where a ray may pass a shape's border.
void add_borders(const ClipPlane& plane, const Ray& ray, std::vector<double>& t) {
  t.push_back(dot(difference(plane.origin, ray.origin), plane.normal) / dot(ray.direction, plane.normal));
}
void add_borders(const ClipBox& box, const Ray& ray, std::vector<double>& t) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double border : {box.bounds[axis].min, box.bounds[axis].max})
      t.push_back((border - ray.origin[axis]) / ray.direction[axis]);
}
void add_borders(const ClipSphere& sphere, const Ray& ray, std::vector<double>& t) {
  const Vector3 offset = difference(sphere.center, ray.origin);
  const double nearest = dot(offset, ray.direction);
  const double rest = sphere.radius * sphere.radius - (dot(offset, offset) - nearest * nearest);
  if (rest <= 0.0) return;
  t.push_back(nearest - std::sqrt(rest));
  t.push_back(nearest + std::sqrt(rest));
}
void add_borders(const ClipVolume&, const Ray&, std::vector<double>&) {}

bool is_kept(const Clipping& clipping, const Vector3& p) {
  const auto agrees = [&](const ClipShape& shape) {
    return std::visit([&](const auto& s) { return contains(s, p); }, shape.shape) == shape.keeps_inside;
  };
  if (clipping.use_union) return std::any_of(clipping.shapes.begin(), clipping.shapes.end(), agrees);
  return std::all_of(clipping.shapes.begin(), clipping.shapes.end(), agrees);
}

/// The pieces of a ray inside the cube that are kept, front to back: between borders nothing changes.
std::vector<Chord> find_kept(const Clipping& clipping, const Ray& ray) {
  const Chord cube = intersect_box(ray, kLower, kUpper);
  if (cube.length() == 0.0) return {};
  std::vector<double> borders{cube.near, cube.far};
  for (const ClipShape& shape : clipping.shapes)
    std::visit([&](const auto& s) { add_borders(s, ray, borders); }, shape.shape);
  std::sort(borders.begin(), borders.end());
  std::vector<Chord> kept;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    if (borders[i] < cube.near || borders[i + 1] > cube.far || borders[i + 1] <= borders[i]) continue;
    if (is_kept(clipping, ray.at(0.5 * (borders[i] + borders[i + 1])))) kept.push_back({borders[i], borders[i + 1]});
  }
  return kept;
}

double kept_length(const Clipping& clipping, const Ray& ray) {
  double length = 0.0;
  for (const Chord& chord : find_kept(clipping, ray)) length += chord.length();
  return length;
}

struct Case {
  Integrator integrator;
  bool is_grid;
};

void PrintTo(const Case& c, std::ostream* out) { *out << name_of(c.integrator) << (c.is_grid ? ", grid" : ", mesh"); }

class Clipped : public ::testing::TestWithParam<Case> {
 protected:
  /// The cube in 7 x 6 x 5 cells.
  static tests::Body cube(const tests::Field& field) {
    if (GetParam().is_grid) {
      tests::GridOptions options;
      options.dimensions = {8, 7, 6};
      return tests::make_grid(options, field);
    }
    tests::BoxOptions options;
    options.bricks = {7, 6, 5};
    return tests::make_box(options, field);
  }
  static RenderSettings make_settings(const Clipping& clipping) {
    RenderSettings settings = make_careful_settings(GetParam().integrator);
    settings.clipping = clipping;
    return settings;
  }
  static void expect_beer(const Clipping& clipping) {
    const tests::Body body = cube([](const Vector3&) { return 0.5; });
    expect_shown(
        body, kHomogeneous, make_settings(clipping),
        [&](const Ray& ray) { return fill(kColor, kExtinction * kept_length(clipping, ray)); },
        constant_tolerance(GetParam().integrator));
  }
};

const ClipPlane kObliquePlane{{0.1, -0.05, 0.02}, {-1.3, 0.7, 2.1}};
const ClipBox kInnerBox{{ValueRange{-0.61, 0.53}, ValueRange{-0.72, 0.81}, ValueRange{-0.9, 0.33}}};
const ClipSphere kOffsetSphere{{0.2, -0.1, 0.15}, 0.83};

TEST_P(Clipped, PlaneKeepsEitherSide) {
  for (const bool keeps_inside : {true, false}) expect_beer({{{kObliquePlane, keeps_inside}}, false});
}

TEST_P(Clipped, BoxKeepsEitherSide) {
  for (const bool keeps_inside : {true, false}) expect_beer({{{kInnerBox, keeps_inside}}, false});
}

TEST_P(Clipped, SphereKeepsEitherSide) {
  for (const bool keeps_inside : {true, false}) expect_beer({{{kOffsetSphere, keeps_inside}}, false});
}

TEST_P(Clipped, PlanesInTheLatticesPlanesCutThere) {
  // Through vertices, edges and faces of the cells.
  const double x = -1.0 + 2.0 * 3 / 7, y = -1.0 + 2.0 * 2 / 6;
  expect_beer({{{ClipPlane{{x, 0, 0}, {1, 0, 0}}, true}, {ClipPlane{{0, y, 0}, {0, -5, 0}}, false}}, false});
}

TEST_P(Clipped, SeveralShapesUniteOrIntersect) {
  const ClipBox box{{ValueRange{-0.91, 0.83}, ValueRange{-0.88, 0.95}, ValueRange{-0.9, 0.93}}};
  for (const bool use_union : {false, true})
    expect_beer({{{kObliquePlane, true}, {box, true}, {kOffsetSphere, use_union}, {ClipSphere{{0, 0, 0}, 0.4}, false}},
                 use_union});
}

TEST_P(Clipped, ManyShapesLeaveManyPieces) {
  Clipping slabs{{}, true};
  for (int i = 0; i < 12; ++i) {
    const double low = -1.0 + 0.16 * i;
    slabs.shapes.push_back({ClipBox{{ValueRange{low, low + 0.07}, ValueRange{-3, 3}, ValueRange{-0.9, 0.95}}}, true});
  }
  expect_beer(slabs);
  Clipping holes;
  for (int i = 0; i < 12; ++i)
    holes.shapes.push_back(
        {ClipSphere{{0.7 * std::sin(2.1 * i), 0.7 * std::cos(1.3 * i), -0.9 + 0.16 * i}, 0.3}, false});
  expect_beer(holes);
}

TEST_P(Clipped, ShapesAtRandom) {
  std::mt19937 random(7);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  const auto place = [&](double reach) {
    const double x = draw(-reach, reach), y = draw(-reach, reach), z = draw(-reach, reach);
    return Vector3{x, y, z};
  };
  const tests::Body body = cube([](const Vector3&) { return 0.5; });
  for (int round = 0; round < 8; ++round) {
    Clipping clipping{{}, round % 2 == 1};
    for (int i = 0; i < 2 + round / 2; ++i) {
      ClipShape shape;
      const Vector3 at = place(0.7);
      if (i % 3 == 0) shape.shape = ClipPlane{at, place(1.0)};
      if (i % 3 == 1) shape.shape = ClipSphere{at, draw(0.3, 1.2)};
      if (i % 3 == 2)
        shape.shape = ClipBox{{ValueRange{at[0] - 0.4, at[0] + 0.6}, ValueRange{at[1] - 0.7, at[1] + 0.5},
                               ValueRange{at[2] - 0.3, at[2] + 0.9}}};
      shape.keeps_inside = draw(0, 1) < 0.7;
      clipping.shapes.push_back(shape);
    }
    Camera camera;
    const Vector3 eye = place(1.0);
    for (int axis = 0; axis < 3; ++axis) camera.position[axis] = 4.0 * eye[axis] / std::sqrt(dot(eye, eye));
    camera.view_up = place(1.0);
    if (round % 3 == 0) camera.parallel_scale = 1.5;
    // Not by `shows`: a random clipping may leave little.
    const Image image = body.draw(kHomogeneous, camera, make_settings(clipping));
    const double allowed = constant_tolerance(GetParam().integrator).opacity;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Ray ray = make_ray(camera, image.width, image.height, x, y);
        ASSERT_NEAR(image.pixel(x, y)[3], -std::expm1(-kExtinction * kept_length(clipping, ray)), allowed)
            << "round " << round << " pixel " << x << ", " << y;
      }
  }
}

TEST_P(Clipped, LinearFieldIsCutWhereItIs) {
  const auto field = [](const Vector3& p) { return 0.5 + 0.2 * p[0] + 0.15 * p[1] - 0.1 * p[2]; };
  const OpticalFunction function{{{0.0, 0.2, kColor}, {1.0, 3.4, kColor}}};
  const Clipping clipping{{{kObliquePlane, true}, {kOffsetSphere, false}}, false};
  expect_shown(
      cube(field), function, make_settings(clipping),
      [&](const Ray& ray) {
        double depth = 0.0;
        for (const Chord& chord : find_kept(clipping, ray))
          depth += chord.length() * (0.2 + 3.2 * field(ray.at(0.5 * (chord.near + chord.far))));
        return fill(kColor, depth);
      },
      varying_tolerance(GetParam().integrator, 2e-4));
}

TEST_P(Clipped, NothingIsKept) {
  const tests::Body body = cube([](const Vector3&) { return 0.5; });
  const Clipping clipping{{{kInnerBox, true}, {kInnerBox, false}}, false};
  const Image image = body.draw(kHomogeneous, standard_cameras()[0].second, make_settings(clipping));
  for (const float value : image.pixels) ASSERT_EQ(value, 0.0f);
}

TEST_P(Clipped, VolumeOfADistanceIsASphere) {
  // The linear field between values of a distance r from a centre lies above it by at most h^2 / (4 r): where it
  // reaches the radius is between two spheres.
  const tests::Body body = cube([](const Vector3&) { return 0.5; });
  const Vector3 center{0.2, -0.1, 0.15};
  const double radius = 0.7;
  for (const std::uint32_t points : {17u, 65u}) {
    tests::GridOptions options;
    options.dimensions = {points, points, points};
    options.lower = {-1.3, -1.2, -1.1};
    options.upper = {1.3, 1.4, 1.5};
    const PreparedGrid distance = prepare_grid(tests::make_grid(options, [&](const Vector3& p) {
      const Vector3 offset = difference(p, center);
      return radius - std::sqrt(dot(offset, offset));
    }));
    const double step = 2.6 / (points - 1), shift = step * step / (4.0 * (radius - 0.1));
    for (const bool keeps_inside : {true, false}) {
      Renderer renderer = body.make_renderer();
      renderer.set_transfer_function(kHomogeneous);
      renderer.set_clip_volume(0, distance);
      const RenderSettings settings = make_settings({{{ClipVolume{"distance", "", 0.0}, keeps_inside}}, false});
      for (const auto& [name, camera] : standard_cameras()) {
        const Image image = renderer.render(camera, settings);
        for (int y = 0; y < image.height; ++y)
          for (int x = 0; x < image.width; ++x) {
            const Ray ray = make_ray(camera, image.width, image.height, x, y);
            double least = 1.0, most = 0.0;
            for (const double r : {radius - shift, radius}) {
              const Clipping sphere{{{ClipSphere{center, r}, keeps_inside}}, false};
              const double alpha = -std::expm1(-kExtinction * kept_length(sphere, ray));
              least = std::min(least, alpha);
              most = std::max(most, alpha);
            }
            const double alpha = image.pixel(x, y)[3];
            ASSERT_GE(alpha, least - 5e-5) << name << " " << points << " pixel " << x << ", " << y;
            ASSERT_LE(alpha, most + 5e-5) << name << " " << points << " pixel " << x << ", " << y;
          }
      }
    }
  }
}

TEST_P(Clipped, VolumeWithoutAGridIsAnError) {
  const tests::Body body = cube([](const Vector3&) { return 0.5; });
  const RenderSettings settings = make_settings({{{ClipVolume{"distance", "", 0.0}, true}}, false});
  EXPECT_THROW(body.draw(kHomogeneous, standard_cameras()[0].second, settings), Error);
}

std::vector<Case> all_cases() {
  std::vector<Case> cases{{Integrator::kPre, true}};
  for (const Integrator integrator : tests::kAllIntegrators)
    for (const bool is_grid : {false, true}) cases.push_back({integrator, is_grid});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, Clipped, ::testing::ValuesIn(all_cases()), [](const auto& test) {
  return name_of(test.param.integrator) + (test.param.is_grid ? "_grid" : "_mesh");
});

}  // namespace
}  // namespace tetravox::analytic
