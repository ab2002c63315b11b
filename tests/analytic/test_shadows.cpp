/// Shadows: a homogeneous cube agrees with Beer's law, and what lies on the way of light absorbs as along any ray.

#include "tests/analytic/lit.h"
#include "tests/common/functions.h"
#include "tests/common/grid_builder.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tetravox::analytic {
namespace {

using View = std::pair<const char*, Camera>;

Light near(const Vector3& position) {
  Light light;
  light.kind = LightKind::kPoint;
  light.position = position;
  return light;
}

/// Unit vector in which light travels at a place that a ray of the eye meets.
Vector3 travel_of(const Light& light, const Ray& ray, const Vector3& place) {
  if (light.kind == LightKind::kDirectional) return normalized(light.direction);
  if (light.kind == LightKind::kPoint) return normalized(difference(place, light.position));
  return ray.direction;
}

/// The way of light through a box to a place: nothing is left of it beyond a light that is near.
Chord way_through(const Vector3& lower, const Vector3& upper, const Light& light, const Vector3& travel,
                  const Vector3& place, const Vector3& eye) {
  Chord way = intersect_box({place, scaled(travel, -1.0)}, lower, upper);
  way.near = std::max(way.near, 0.0);
  if (light.kind == LightKind::kPoint) way.far = std::min(way.far, norm(difference(place, light.position)));
  if (light.kind == LightKind::kHeadlight) way.far = std::min(way.far, norm(difference(place, eye)));
  return way;
}

/// See docs/methods/light.md: w.
double strength_of(const tests::Body& body, const Lighting& lighting) {
  const double range = body.scalar_range().max - body.scalar_range().min;
  const double half = lighting.gradient_threshold * range / tests::diagonal_of(body.bounds());
  return dot(kSlope, kSlope) / (dot(kSlope, kSlope) + half * half);
}

class Shadowed : public Lit {
 protected:
  static RenderSettings make_shadows(ShadowKind kind, const Light& light) {
    RenderSettings settings = make_settings(1e-4);
    settings.lighting.lights = {light};
    settings.lighting.material = {0.2, 0.8, 0.3, 12.0};
    settings.lighting.shadows = kind;
    return settings;
  }

  /// What reaches a place: of the ray to it, the way of the light.
  using Reaching = std::function<double(const Ray& ray, const Vector3& place)>;

  /// Holds a picture of the cube against emission in the light that reaches it. `max` and `rms`: allowed differences.
  static void expect_light(const tests::Body& body, const RenderSettings& settings, const View& view,
                           const Reaching& reaching, double max, double rms,
                           const std::function<Chord(const Ray&)>& chord_of = {}) {
    const Image image = body.draw(kHomogeneous, view.second, settings);
    Image expected = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Ray ray = make_ray(view.second, image.width, image.height, x, y);
        const auto light_at = [&](const Vector3& place) {
          return illuminate(settings.lighting, ray.direction, place, {}, 0.0,
                            [&](const Light&, const Vector3& p) { return reaching(ray, p); });
        };
        const Chord chord = chord_of ? chord_of(ray) : intersect_box(ray, kLower, kUpper);
        const Rgba wanted = integrate_lit(ray, chord, kColor, light_at, 600);
        for (int k = 0; k < 4; ++k) expected.pixel(x, y)[k] = static_cast<float>(wanted[k]);
      }
    EXPECT_GT(tests::count_covered(image), 400u) << view.first;
    EXPECT_TRUE(tests::images_agree(image, expected, max, rms)) << view.first;
  }

  static void expect_beer(const Light& light, const View& view, double max, double rms,
                          ShadowKind kind = ShadowKind::kVolume) {
    const int cells = kind == ShadowKind::kExact ? 12 : is_grid() ? 64 : 24;  // rays need no small ones
    const tests::Body body = cube(cells, [](const Vector3&) { return 0.5; });
    expect_light(
        body, make_shadows(kind, light), view,
        [&](const Ray& ray, const Vector3& place) {
          const Vector3 travel = travel_of(light, ray, place);
          return std::exp(-kExtinction *
                          way_through(kLower, kUpper, light, travel, place, view.second.position).length());
        },
        max, rms);
  }
  /// Where edges of the cube lie between the places of the lattice, the depth behind them has a kink.
  static void expect_beer_with_kinks(const Light& light, const View& view) { expect_beer(light, view, 1e-2, 1e-3); }
  /// Rays have none of that.
  static void expect_exact_beer(const Light& light, const View& view) {
    SCOPED_TRACE(name_of(light.kind));
    expect_beer(light, view, 1e-4, 3e-5, ShadowKind::kExact);
  }
};

TEST_P(Shadowed, LightAlongAnAxis) {
  for (const auto& view : standard_cameras())
    for (const Vector3& direction : {Vector3{1, 0, 0}, Vector3{0, -3, 0}, Vector3{0, 0, 1}})
      expect_beer(directional(direction), view, 1e-3, 5e-4);
}

TEST_P(Shadowed, LightFromTheSide) {
  for (const auto& view : standard_cameras()) expect_beer_with_kinks(directional({1.0, -0.6, 0.4}), view);
}

TEST_P(Shadowed, LightAlongTheViewAndAgainstIt) {
  const auto view = standard_cameras()[1];
  const Vector3 along = difference(view.second.focal_point, view.second.position);
  for (const double sign : {1.0, -1.0}) expect_beer_with_kinks(directional(scaled(along, sign)), view);
}

TEST_P(Shadowed, Headlight) {
  const auto cameras = standard_cameras();
  for (const std::size_t i : {0u, 1u}) expect_beer_with_kinks({}, cameras[i]);
}

TEST_P(Shadowed, PointLight) {
  for (const Vector3& position : {Vector3{3.0, -2.0, 2.5}, Vector3{1.4, 0.2, -0.1}})
    for (const auto& view : standard_cameras()) expect_beer_with_kinks(near(position), view);
}

TEST_P(Shadowed, ExactForLightFromAnyDirection) {
  for (const auto& view : standard_cameras())
    for (const Vector3& direction :
         {Vector3{1, 0, 0}, Vector3{0, -3, 0}, Vector3{0, 0, 1}, Vector3{1.0, -0.6, 0.4}, Vector3{-1, 1, 1}})
      expect_exact_beer(directional(direction), view);
}

TEST_P(Shadowed, ExactForLightAlongTheViewAndAgainstIt) {
  const auto view = standard_cameras()[1];
  const Vector3 along = difference(view.second.focal_point, view.second.position);
  for (const double sign : {1.0, -1.0}) expect_exact_beer(directional(scaled(along, sign)), view);
}

TEST_P(Shadowed, ExactForHeadlights) {
  for (const auto& view : standard_cameras()) expect_exact_beer({}, view);
}

TEST_P(Shadowed, ExactForPointLights) {
  // Far, near, inside.
  for (const Vector3& position : {Vector3{3.0, -2.0, 2.5}, Vector3{1.4, 0.2, -0.1}, Vector3{0.3, -0.45, 0.1}})
    for (const auto& view : standard_cameras()) expect_exact_beer(near(position), view);
}

TEST_P(Shadowed, ExactInAFieldThatVaries) {
  // Extinction linear in a field that is linear: its integral towards the light is known.
  const tests::Body body = cube(is_grid() ? 20 : 10, linear_field);
  const OpticalFunction function{{{0.0, 0.3, kColor}, {1.0, 2.3, kColor}}};
  const auto extinction_at = [](const Vector3& p) { return 0.3 + 2.0 * linear_field(p); };
  const Light light = directional({1.0, -0.6, 0.4});
  const RenderSettings settings = make_shadows(ShadowKind::kExact, light);
  for (const View& view : standard_cameras()) {
    const auto expected = [&](const Ray& ray) {
      const Chord chord = intersect_box(ray, kLower, kUpper);
      if (chord.length() == 0.0) return Rgba{};
      return integrate(
          chord.length(),
          [&](double u) {
            const Vector3 place = ray.at(chord.near + u * chord.length()), travel = travel_of(light, ray, place);
            const Chord way = way_through(kLower, kUpper, light, travel, place, view.second.position);
            const Vector3 middle = difference(place, scaled(travel, 0.5 * way.length()));
            const double reaching = std::exp(-extinction_at(middle) * way.length());
            const Illumination lit =
                illuminate(settings.lighting, ray.direction, place, kSlope, strength_of(body, settings.lighting),
                           [&](const Light&, const Vector3&) { return reaching; });
            return Medium{extinction_at(place), lit.apply(kColor)};
          },
          600);
    };
    EXPECT_TRUE(shows(body.draw(function, view.second, settings), view.second, expected, {4e-4, 1e-4})) << view.first;
  }
}

TEST_P(Shadowed, ExactBehindSurfaces) {
  // A plane across the cube: opaque, or letting some light through, and of one side alone.
  const Vector3 normal = normalized({1.0, 0.2, -0.3});
  const auto field = [&](const Vector3& p) { return dot(normal, p); };
  const double value = 0.13;
  const tests::Body body = cube(is_grid() ? 24 : 10, field);
  for (const auto& [opacity, is_two_sided, towards] : {std::tuple{1.0, true, 1.0}, std::tuple{0.4, true, -1.0},
                                                       std::tuple{0.7, false, 1.0}, std::tuple{0.7, false, -1.0}}) {
    const Light light = directional(scaled({1.0, -0.4, 0.3}, towards));
    RenderSettings settings = make_shadows(ShadowKind::kExact, light);
    settings.lighting.gradient_threshold = 1e6;  // the volume needs no normals
    settings.surfaces = {{value, {0.2, 0.9, 0.3}, {0.8, 0.1, 0.9}, opacity, is_two_sided}};
    for (const View& view : standard_cameras()) {
      const auto reaching = [&](const Ray& ray, const Vector3& place) {
        const Vector3 travel = travel_of(light, ray, place);
        const Chord way = way_through(kLower, kUpper, light, travel, place, view.second.position);
        const Vector3 entry = difference(place, scaled(travel, way.length()));
        const bool is_met = (field(entry) < value) != (field(place) < value);
        const bool is_seen = is_met && (is_two_sided || field(entry) < value);
        return std::exp(-kExtinction * way.length()) * (is_seen ? 1.0 - opacity : 1.0);
      };
      const auto light_at = [&](const Ray& ray, const Vector3& place, double strength) {
        return illuminate(settings.lighting, ray.direction, place, normal, strength,
                          [&](const Light&, const Vector3& p) { return reaching(ray, p); });
      };
      const auto expected = [&](const Ray& ray) {
        const Chord chord = intersect_box(ray, kLower, kUpper);
        if (chord.length() == 0.0) return Rgba{};
        const auto volume = [&](const Chord& part) {
          return integrate_lit(
              ray, part, kColor, [&](const Vector3& p) { return light_at(ray, p, 0.0); }, 600);
        };
        const double slope = dot(normal, ray.direction), at = (value - field(ray.origin)) / slope;
        if (at <= chord.near || at >= chord.far) return volume(chord);
        const Isosurface& sheet = settings.surfaces[0];
        const double covers = slope > 0.0 || is_two_sided ? opacity : 0.0;
        // Lit from the side that the light comes from: nothing of the sheet is on its way.
        const Vector3 place = ray.at(at), travel = travel_of(light, ray, place);
        const Vector3 off = difference(place, scaled(travel, 1e-6));
        const Color lit = light_at(ray, off, 1.0).apply(slope > 0.0 ? sheet.front_color : sheet.back_color);
        const Rgba surface{covers * lit[0], covers * lit[1], covers * lit[2], covers};
        return over(volume({chord.near, at}), over(surface, volume({at, chord.far})));
      };
      EXPECT_TRUE(shows(body.draw(kHomogeneous, view.second, settings), view.second, expected, {2.5e-3, 5e-5}))
          << view.first << " opacity " << opacity << " light " << towards;
    }
  }
}

TEST_P(Shadowed, ExactWhereClippingLeavesALightFree) {
  // A slab is cut out of the cube: light passes it unhindered.
  const tests::Body body = cube(is_grid() ? 24 : 10, [](const Vector3&) { return 0.5; });
  const Vector3 lower{-2, -0.4, -2}, upper{2, 0.1, 2};
  for (const Light& light : {directional({0.3, -1.0, 0.4}), near({0.2, 1.7, 0.4}), Light{}}) {
    RenderSettings settings = make_shadows(ShadowKind::kExact, light);
    settings.clipping.shapes = {
        {ClipBox{{ValueRange{lower[0], upper[0]}, {lower[1], upper[1]}, {lower[2], upper[2]}}}, false}};
    for (const View& view : standard_cameras()) {
      const auto light_at = [&](const Ray& ray, const Vector3& place) {
        const Vector3 travel = travel_of(light, ray, place);
        const Vector3& eye = view.second.position;
        const Vector3 low{std::max(lower[0], -1.0), lower[1], -1.0}, high{1.0, upper[1], 1.0};
        const double depth = way_through(kLower, kUpper, light, travel, place, eye).length() -
                             way_through(low, high, light, travel, place, eye).length();
        return illuminate(settings.lighting, ray.direction, place, {}, 0.0,
                          [&](const Light&, const Vector3&) { return std::exp(-kExtinction * depth); });
      };
      const auto expected = [&](const Ray& ray) {
        const Chord whole = intersect_box(ray, kLower, kUpper), hole = intersect_box(ray, lower, upper);
        const auto part = [&](double from, double to) {
          return integrate_lit(
              ray, {from, std::max(from, to)}, kColor, [&](const Vector3& p) { return light_at(ray, p); }, 600);
        };
        if (hole.length() == 0.0 || hole.far <= whole.near || hole.near >= whole.far)
          return part(whole.near, whole.far);
        return over(part(whole.near, hole.near), part(std::max(whole.near, hole.far), whole.far));
      };
      EXPECT_TRUE(shows(body.draw(kHomogeneous, view.second, settings), view.second, expected, {2e-4, 5e-5}))
          << view.first << " " << name_of(light.kind);
    }
  }
}

TEST_P(Shadowed, ExactFromBlockToBlock) {
  // Two blocks with nothing between them: a mesh with a gap, a grid with missing values.
  const auto is_gap = [](double x) { return x > -0.2001 && x < 0.2001; };
  const auto make_body = [&]() -> tests::Body {
    if (is_grid()) {
      tests::GridOptions options;
      options.dimensions = {31, 31, 31};
      return tests::make_grid(options, [&](const Vector3& p) {
        return p[0] > -0.19 && p[0] < 0.19 ? std::numeric_limits<double>::quiet_NaN() : 0.5;
      });
    }
    tests::BoxOptions options;
    options.bricks = {30, 10, 10};
    options.type = CellType::kTetrahedron;
    options.is_hole = [&](int i, int, int) { return is_gap(-1.0 + (i + 0.5) / 15.0); };
    return tests::make_box(options, [](const Vector3&) { return 0.5; });
  };
  const tests::Body body = make_body();
  const Vector3 left{-0.2, 1, 1}, right{0.2, -1, -1};
  for (const Light& light : {directional({1.0, -0.3, 0.2}), near({2.0, 0.4, 0.3}), near({0.0, 0.1, 0.2})}) {
    const RenderSettings settings = make_shadows(ShadowKind::kExact, light);
    for (const View& view : standard_cameras()) {
      const auto light_at = [&](const Ray& ray, const Vector3& place) {
        const Vector3 travel = travel_of(light, ray, place);
        const Vector3& eye = view.second.position;
        const double depth = way_through(kLower, left, light, travel, place, eye).length() +
                             way_through(right, kUpper, light, travel, place, eye).length();
        return illuminate(settings.lighting, ray.direction, place, {}, 0.0,
                          [&](const Light&, const Vector3&) { return std::exp(-kExtinction * depth); });
      };
      const auto expected = [&](const Ray& ray) {
        const auto part = [&](const Chord& chord) {
          return integrate_lit(
              ray, chord, kColor, [&](const Vector3& p) { return light_at(ray, p); }, 600);
        };
        const Rgba a = part(intersect_box(ray, kLower, left)), b = part(intersect_box(ray, right, kUpper));
        return ray.direction[0] > 0.0 ? over(a, b) : over(b, a);
      };
      EXPECT_TRUE(shows(body.draw(kHomogeneous, view.second, settings), view.second, expected, {2e-4, 5e-5}))
          << view.first << " " << name_of(light.kind);
    }
  }
}

TEST_P(Shadowed, ExactInConstantCells) {
  // Layers across the light, thick and thin by turns.
  const auto layer_of = [](const Vector3& p) { return static_cast<int>(std::floor((p[2] + 1.0) * 4.0)); };
  const auto field = [&](const Vector3& p) { return layer_of(p) % 2 == 0 ? 0.25 : 0.75; };
  const auto extinction_of = [](int layer) { return layer % 2 == 0 ? 0.4 : 2.2; };
  const auto make_body = [&]() -> tests::Body {
    if (is_grid()) {
      tests::GridOptions options;
      options.dimensions = {9, 9, 9};
      options.association = Association::kCell;
      return tests::make_grid(options, field);
    }
    tests::BoxOptions options;
    options.bricks = {8, 8, 8};
    options.association = Association::kCell;
    return tests::make_box(options, field);
  };
  const tests::Body body = make_body();
  const OpticalFunction function{{{0.0, 0.4, kColor}, {0.5, 0.4, kColor}, {0.5, 2.2, kColor}, {1.0, 2.2, kColor}}};
  const Light light = directional({0.2, 0.3, -1.0});
  RenderSettings settings = make_shadows(ShadowKind::kExact, light);
  settings.lighting.gradient_threshold = 1e6;
  const auto lower_of = [](int layer) { return Vector3{-1.0, -1.0, -1.0 + 0.25 * layer}; };
  const auto upper_of = [](int layer) { return Vector3{1.0, 1.0, -0.75 + 0.25 * layer}; };
  const auto reaching = [&](const Light&, const Vector3& place) {
    double depth = 0.0;
    for (int layer = 0; layer < 8; ++layer)
      depth += extinction_of(layer) *
               way_through(lower_of(layer), upper_of(layer), light, normalized(light.direction), place, {}).length();
    return std::exp(-depth);
  };
  for (const View& view : standard_cameras()) {
    const auto expected = [&](const Ray& ray) {
      Rgba sum{};
      for (int i = 0; i < 8; ++i) {
        const int layer = ray.direction[2] > 0.0 ? i : 7 - i;
        const Chord chord = intersect_box(ray, lower_of(layer), upper_of(layer));
        if (chord.length() == 0.0) continue;
        const auto medium_at = [&](double u) {
          const Vector3 place = ray.at(chord.near + u * chord.length());
          return Medium{extinction_of(layer),
                        illuminate(settings.lighting, ray.direction, place, {}, 0.0, reaching).apply(kColor)};
        };
        sum = over(sum, integrate(chord.length(), medium_at, 200));
      }
      return sum;
    };
    EXPECT_TRUE(shows(body.draw(function, view.second, settings), view.second, expected, {6e-4, 5e-5})) << view.first;
  }
}

TEST_P(Shadowed, ExactIsWhatAFineLatticeComesTo) {
  const tests::Body body = cube(14, tests::make_random_field(11, 2.0));
  const OpticalFunction function{
      {{0.2, 0.0, {0.1, 0.2, 0.9}}, {0.5, 3.0, {0.9, 0.7, 0.2}}, {0.9, 0.7, {0.9, 0.1, 0.1}}}};
  const View view = standard_cameras()[0];
  for (const OpacityWeight weight :
       {OpacityWeight::kNone, OpacityWeight::kGradient, OpacityWeight::kScalarDifference}) {
    RenderSettings settings = make_shadows(ShadowKind::kExact, directional({1.0, -0.6, 0.4}));
    settings.lighting.lights.push_back(near({0.5, 2.0, 1.5}));
    settings.opacity_weight = weight;
    settings.opacity_weight_scale = 0.4;
    const Image exact = body.draw(function, view.second, settings);
    settings.lighting.shadows = ShadowKind::kVolume;
    settings.lighting.shadow_resolution = 256;
    const Image lattice = body.draw(function, view.second, settings);
    settings.lighting.shadows = ShadowKind::kNone;
    const Image unshadowed = body.draw(function, view.second, settings);
    EXPECT_FALSE(tests::images_agree(exact, unshadowed, 0.1));
    EXPECT_TRUE(tests::images_agree(exact, lattice, 1.2e-2, 1.5e-3)) << name_of(weight);
  }
}

TEST_P(Shadowed, ExactIsTheSameTurnedAndUneven) {
  if (!is_grid()) return;
  // The same field in a turned frame with uneven axes: linear, so that cells do not matter.
  tests::GridOptions options;
  options.dimensions = {14, 17, 12};
  tests::GridOptions uneven = options;
  uneven.fractions = {tests::growing_fractions(14, 4.0), {}, tests::growing_fractions(12, 0.3)};
  const std::array<double, 9> turn{0.8, -0.6, 0.0, 0.48, 0.64, -0.6, 0.36, 0.48, 0.8};
  const auto turned = [&](const Vector3& p, bool is_inverse) {
    Vector3 q{};
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t i = 0; i < 3; ++i) q[row] += turn[is_inverse ? 3 * i + row : 3 * row + i] * p[i];
    return q;
  };
  uneven.direction = turn;
  const tests::Body body(tests::make_grid(options, linear_field));
  const tests::Body other(tests::make_grid(uneven, [&](const Vector3& p) { return linear_field(turned(p, true)); }));
  const OpticalFunction function{{{0.0, 0.3, kColor}, {1.0, 2.3, kColor}}};
  RenderSettings settings = make_shadows(ShadowKind::kExact, directional({1.0, -0.6, 0.4}));
  settings.lighting.lights.push_back(near({0.5, 2.0, 1.5}));
  settings.surfaces = {{0.6, {0.2, 0.9, 0.3}, {0.8, 0.1, 0.9}, 0.6, true}};
  settings.lighting.gradient_threshold = 0.0;  // it goes by the bounds
  RenderSettings moved = settings;
  for (Light& light : moved.lighting.lights) {
    light.direction = turned(light.direction, false);
    light.position = turned(light.position, false);
  }
  for (const View& view : standard_cameras()) {
    Camera camera = view.second;
    for (Vector3* vector : {&camera.position, &camera.focal_point, &camera.view_up}) *vector = turned(*vector, false);
    EXPECT_TRUE(tests::images_agree(other.draw(function, camera, moved), body.draw(function, view.second, settings),
                                    2.5e-3, 1e-4))
        << view.first;
  }
}

TEST_P(Shadowed, ExactIsTheSameWithEveryInstructionSetAndAnyThreads) {
  const tests::Body body = cube(14, tests::make_random_field(11, 2.0));
  const OpticalFunction function{
      {{0.2, 0.0, {0.1, 0.2, 0.9}}, {0.5, 3.0, {0.9, 0.7, 0.2}}, {0.9, 0.7, {0.9, 0.1, 0.1}}}};
  RenderSettings settings = make_shadows(ShadowKind::kExact, {});
  settings.lighting.lights.push_back(directional({1.0, -0.6, 0.4}));
  settings.lighting.ambient_occlusion = 4;
  settings.lighting.shadow_resolution = 16;
  settings.surfaces = {{0.4, {0.9, 0.2, 0.1}, {0.1, 0.3, 0.8}, 0.5, true}, {0.6, {1, 1, 1}, {1, 1, 0}, 0.7, false}};
  settings.clipping.shapes = {{ClipSphere{{0.1, 0.2, 0}, 1.1}, true}, {ClipPlane{{0.2, 0, 0}, {-1, 0.3, 2}}, true}};
  const Camera camera = standard_cameras()[0].second;
  settings.threads = 1;
  const Image image = body.draw(function, camera, settings);
  EXPECT_GT(tests::count_covered(image), 300u);
  settings.threads = 3;
  EXPECT_TRUE(tests::images_equal(body.draw(function, camera, settings), image));
  for (const std::string& set : instruction_sets()) {
    settings.instruction_set = set;
    EXPECT_TRUE(tests::images_equal(body.draw(function, camera, settings), image)) << set;
  }
}

TEST_P(Shadowed, WhatShadowsDependOnIsSeenAgain) {
  const tests::Body body = cube(12, linear_field);
  const Camera camera = standard_cameras()[0].second;
  Renderer renderer = body.make_renderer();
  RenderSettings settings = make_settings(1e-3);
  settings.lighting.shadows = ShadowKind::kVolume;
  settings.lighting.shadow_resolution = 32;
  settings.lighting.lights = {directional({1, 0, 0})};
  const auto sphere_grid = [](double radius) {
    return tests::make_grid({}, [radius](const Vector3& p) { return radius - norm(p); });
  };
  const PreparedGrid large = prepare_grid(sphere_grid(0.9)), small = prepare_grid(sphere_grid(0.5));
  const PreparedGrid* volume = &large;
  OpticalFunction function = kHomogeneous;
  const auto expect_fresh = [&](const char* what) {
    renderer.set_transfer_function(function);
    renderer.set_clip_volume(0, *volume);
    Renderer fresh = body.make_renderer();
    fresh.set_transfer_function(function);
    fresh.set_clip_volume(0, *volume);
    EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings), fresh.render(camera, settings))) << what;
  };
  expect_fresh("first");
  settings.lighting.lights[0].direction = {0, 1, 0};
  expect_fresh("light");
  settings.lighting.shadow_resolution = 24;
  expect_fresh("resolution");
  function.points[0].extinction = 2.5;
  expect_fresh("function");
  settings.surfaces = {{0.4, {1, 0, 0}, {0, 1, 0}, 0.7, true}};
  expect_fresh("surface");
  settings.clipping.shapes = {{ClipPlane{{0.1, 0, 0}, {1, 1, 0}}, true}};
  expect_fresh("clip plane");
  settings.clipping.shapes = {{ClipVolume{"a.nrrd", "", 0.0}, true}};
  expect_fresh("clip volume");
  volume = &small;
  expect_fresh("another clip volume");
  settings.opacity_weight = OpacityWeight::kGradient;
  expect_fresh("opacity weight");
  settings.lighting.ambient_occlusion = 8;
  expect_fresh("occlusion");
  settings.lighting.occlusion_seed = 7;
  expect_fresh("occlusion's seed");
}

TEST_P(Shadowed, AnotherClipVolumeThrowsAnotherShadow) {
  const tests::Body body = cube(12, linear_field);
  const Camera camera = standard_cameras()[0].second;
  RenderSettings settings = make_settings(1e-3);
  settings.lighting.shadows = ShadowKind::kVolume;
  settings.lighting.shadow_resolution = 32;
  settings.lighting.lights = {directional({1, 0, 0})};
  settings.lighting.ambient_occlusion = 4;
  settings.clipping.shapes = {{ClipVolume{"a.nrrd", "", 0.0}, true}};
  const auto sphere_grid = [](double radius) {
    return prepare_grid(tests::make_grid({}, [radius](const Vector3& p) { return radius - norm(p); }));
  };
  const PreparedGrid large = sphere_grid(0.9), small = sphere_grid(0.5);
  Renderer kept = body.make_renderer(), fresh = body.make_renderer();
  kept.set_transfer_function(kHomogeneous);
  fresh.set_transfer_function(kHomogeneous);
  kept.set_clip_volume(0, large);
  kept.render(camera, settings);
  kept.set_clip_volume(0, small);
  fresh.set_clip_volume(0, small);
  EXPECT_TRUE(tests::images_equal(kept.render(camera, settings), fresh.render(camera, settings)));
}

INSTANTIATE_TEST_SUITE_P(All, Shadowed, ::testing::Bool(), kNameOfBody);

}  // namespace
}  // namespace tetravox::analytic
