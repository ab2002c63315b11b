/// Functions given as opacities for a unit distance, and cell data, in closed form, in meshes and grids.

#include "tests/analytic/show.h"
#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <cmath>

namespace tetravox::analytic {
namespace {

const Vector3 kLower{-1, -1, -1};
const Vector3 kUpper{1, 1, 1};

struct Case {
  Integrator integrator;
  bool is_grid;
};

void PrintTo(const Case& c, std::ostream* out) { *out << name_of(c.integrator) << (c.is_grid ? ", grid" : ", mesh"); }

class Integrators : public ::testing::TestWithParam<Case> {
 protected:
  /// A box of 4 x 3 x 2 cells.
  static tests::Body box(const tests::Field& field, Association association = Association::kPoint) {
    if (GetParam().is_grid) {
      tests::GridOptions options;
      options.dimensions = {5, 4, 3};
      options.association = association;
      return tests::make_grid(options, field);
    }
    tests::BoxOptions options;
    options.bricks = {4, 3, 2};
    options.association = association;
    return tests::make_box(options, field);
  }
  static void expect_shown(const tests::Body& body, const OpticalFunction& function,
                           const std::function<Rgba(const Ray&)>& expected, const Tolerance& tolerance) {
    analytic::expect_shown(body, function, make_careful_settings(GetParam().integrator), expected, tolerance);
  }
  static Tolerance tolerance() { return constant_tolerance(GetParam().integrator); }
};

TEST_P(Integrators, OpacityHoldsForItsUnitDistance) {
  TransferFunction given{{{0.0, {0.3, 0.6, 0.9}, 0.3}}, Absorption::kOpacity, 0.5};
  expect_shown(
      box([](const Vector3& p) { return p[0]; }), make_optical_function(given, 99.0),
      [](const Ray& ray) {
        const double length = intersect_box(ray, kLower, kUpper).length();
        const double alpha = 1.0 - std::pow(0.7, length / 0.5);
        return Rgba{0.3 * alpha, 0.6 * alpha, 0.9 * alpha, alpha};
      },
      tolerance());
}

TEST_P(Integrators, OpacityOfOneIsAlmostOpaque) {
  // Over a hundredth of the unit distance, opacity 1 - 1e-6 lets 0.871 of the light through.
  TransferFunction given{{{0.0, {1, 1, 1}, 1.0}}, Absorption::kOpacity, std::nullopt};
  expect_shown(
      box([](const Vector3& p) { return p[0]; }), make_optical_function(given, 200.0),
      [](const Ray& ray) {
        return fill({1, 1, 1}, -std::log(1e-6) / 200.0 * intersect_box(ray, kLower, kUpper).length());
      },
      tolerance());
}

TEST_P(Integrators, LinearOpacityHasTheIntegralOfItsLogarithm) {
  // Opacity equals the scalar, which is linear along the ray; integral of -ln(1 - x) is (1 - x) ln(1 - x) + x.
  TransferFunction given{{{0.0, {0.8, 0.4, 0.2}, 0.0}, {1.0, {0.8, 0.4, 0.2}, 1.0}}, Absorption::kOpacity, 1.3};
  const auto field = [](const Vector3& p) { return 0.5 + 0.2 * p[0] + 0.15 * p[1] - 0.1 * p[2]; };
  const auto integral = [](double x) { return (1.0 - x) * std::log1p(-x) + x; };
  expect_shown(box(field), make_optical_function(given, 99.0),
               [&](const Ray& ray) {
                 const Chord chord = intersect_box(ray, kLower, kUpper);
                 if (chord.length() == 0.0) return Rgba{};
                 const double front = field(ray.at(chord.near)), back = field(ray.at(chord.far));
                 const double mean = (integral(back) - integral(front)) / (back - front);
                 return fill({0.8, 0.4, 0.2}, mean * chord.length() / 1.3);
               },
               {1e-3, 1e-3});
}

TEST_P(Integrators, CellDataIsConstantInEachCell) {
  // Four layers along x; the transmittance is the product over the layers, exactly.
  const double extinctions[4] = {0.4, 3.0, 0.0, 1.1};
  const Color colors[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.5, 0.5}};
  OpticalFunction function;
  for (int i = 0; i < 4; ++i) function.points.push_back({i + 0.5, extinctions[i], colors[i]});
  expect_shown(
      box([](const Vector3& p) { return std::floor(2.0 * (p[0] + 1.0)) + 0.5; }, Association::kCell), function,
      [&](const Ray& ray) {
        Rgba result{};
        for (int i = 0; i < 4; ++i) {
          const int layer = ray.direction[0] > 0.0 ? i : 3 - i;
          const double x = -1.0 + 0.5 * layer;
          const Chord chord = intersect_box(ray, {x, -1, -1}, {x + 0.5, 1, 1});
          result = over(result, fill(colors[layer], extinctions[layer] * chord.length()));
        }
        return result;
      },
      tolerance());
}

TEST_P(Integrators, CellDataAtAStepTakesTheLimitFromAbove) {
  const OpticalFunction function{{{0.5, 0.2, {1, 0, 0}}, {0.5, 1.4, {0, 1, 0}}}};
  expect_shown(
      box([](const Vector3&) { return 0.5; }, Association::kCell), function,
      [&](const Ray& ray) {
        return fill({0, 1, 0}, 1.4 * intersect_box(ray, kLower, kUpper).length());
      },
      tolerance());
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const Integrator integrator : tests::kAllIntegrators)
    for (const bool is_grid : {false, true}) cases.push_back({integrator, is_grid});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, Integrators, ::testing::ValuesIn(all_cases()), [](const auto& test) {
  return name_of(test.param.integrator) + (test.param.is_grid ? "_grid" : "_mesh");
});

}  // namespace
}  // namespace tetravox::analytic
