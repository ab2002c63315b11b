/// Functions given as opacities for a unit distance, and cell data, in closed form.

#include "tests/analytic/closed_form.h"
#include "tests/common/draw.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <cmath>

namespace tetravox::analytic {
namespace {

using tests::BoxOptions;
using tests::make_box;
using tests::make_settings;

const Vector3 kLower{-1, -1, -1};
const Vector3 kUpper{1, 1, 1};

class Integrators : public ::testing::TestWithParam<Integrator> {
 protected:
  RenderSettings settings() const {
    RenderSettings result = make_settings(GetParam(), 61, 43);
    result.samples = 256;
    result.use_early_ray_termination = false;
    return result;
  }
  /// Constant media: rounding, which grows with the number of samples.
  Tolerance tolerance() const {
    return GetParam() == Integrator::kPost ? Tolerance{5e-5, 5e-5} : Tolerance{1e-5, 1e-5};
  }
};

TEST_P(Integrators, OpacityHoldsForItsUnitDistance) {
  TransferFunction given{{{0.0, {0.3, 0.6, 0.9}, 0.3}}, Absorption::kOpacity, 0.5};
  const MeshData mesh = make_box({}, [](const Vector3& p) { return p[0]; });
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = tests::draw(mesh, make_optical_function(given, 99.0), camera, settings());
    EXPECT_TRUE(shows(
        image, camera,
        [](const Ray& ray) {
          const double length = intersect_box(ray, kLower, kUpper).length();
          const double alpha = 1.0 - std::pow(0.7, length / 0.5);
          return Rgba{0.3 * alpha, 0.6 * alpha, 0.9 * alpha, alpha};
        },
        tolerance()))
        << name;
  }
}

TEST_P(Integrators, OpacityOfOneIsAlmostOpaque) {
  // Over a hundredth of the unit distance, opacity 1 - 1e-6 lets 0.871 of the light through.
  TransferFunction given{{{0.0, {1, 1, 1}, 1.0}}, Absorption::kOpacity, std::nullopt};
  const MeshData mesh = make_box({}, [](const Vector3& p) { return p[0]; });
  const Camera camera = standard_cameras()[0].second;
  const Image image = tests::draw(mesh, make_optical_function(given, 200.0), camera, settings());
  EXPECT_TRUE(shows(
      image, camera,
      [](const Ray& ray) {
        return fill({1, 1, 1}, -std::log(1e-6) / 200.0 * intersect_box(ray, kLower, kUpper).length());
      },
      tolerance()));
}

TEST_P(Integrators, LinearOpacityHasTheIntegralOfItsLogarithm) {
  // Opacity equals the scalar, which is linear along the ray; integral of -ln(1 - x) is (1 - x) ln(1 - x) + x.
  TransferFunction given{{{0.0, {0.8, 0.4, 0.2}, 0.0}, {1.0, {0.8, 0.4, 0.2}, 1.0}}, Absorption::kOpacity, 1.3};
  const auto field = [](const Vector3& p) { return 0.5 + 0.2 * p[0] + 0.15 * p[1] - 0.1 * p[2]; };
  const auto integral = [](double x) { return (1.0 - x) * std::log1p(-x) + x; };
  const MeshData mesh = make_box({}, field);
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = tests::draw(mesh, make_optical_function(given, 99.0), camera, settings());
    EXPECT_TRUE(shows(
        image, camera,
        [&](const Ray& ray) {
          const Chord chord = intersect_box(ray, kLower, kUpper);
          if (chord.length() == 0.0) return Rgba{};
          const double front = field(ray.at(chord.near)), back = field(ray.at(chord.far));
          const double mean = (integral(back) - integral(front)) / (back - front);
          return fill({0.8, 0.4, 0.2}, mean * chord.length() / 1.3);
        },
        Tolerance{1e-3, 1e-3}))
        << name;
  }
}

TEST_P(Integrators, CellDataIsConstantInEachCell) {
  // Four layers along x; the transmittance is the product over the layers, exactly.
  const double extinctions[4] = {0.4, 3.0, 0.0, 1.1};
  const Color colors[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.5, 0.5}};
  OpticalFunction function;
  for (int i = 0; i < 4; ++i) function.points.push_back({i + 0.5, extinctions[i], colors[i]});
  BoxOptions options;
  options.bricks = {4, 3, 2};
  options.association = Association::kCell;
  const MeshData mesh = make_box(options, [](const Vector3& p) { return std::floor(2.0 * (p[0] + 1.0)) + 0.5; });
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = tests::draw(mesh, function, camera, settings());
    EXPECT_TRUE(shows(
        image, camera,
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
        tolerance()))
        << name;
  }
}

TEST_P(Integrators, CellDataAtAStepTakesTheLimitFromAbove) {
  const OpticalFunction function{{{0.5, 0.2, {1, 0, 0}}, {0.5, 1.4, {0, 1, 0}}}};
  BoxOptions options;
  options.association = Association::kCell;
  const MeshData mesh = make_box(options, [](const Vector3&) { return 0.5; });
  const Camera camera = standard_cameras()[0].second;
  const Image image = tests::draw(mesh, function, camera, settings());
  EXPECT_TRUE(shows(
      image, camera,
      [&](const Ray& ray) {
        return fill({0, 1, 0}, 1.4 * intersect_box(ray, kLower, kUpper).length());
      },
      tolerance()));
}

INSTANTIATE_TEST_SUITE_P(All, Integrators, ::testing::ValuesIn(tests::kAllIntegrators),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace tetravox::analytic
