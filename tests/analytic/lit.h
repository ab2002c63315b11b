#pragma once

/// The lit cube, and what rays through it must show.

#include "tests/analytic/cube.h"
#include "tests/analytic/light_model.h"
#include "tests/analytic/show.h"

#include <functional>

namespace tetravox::analytic {

inline double linear_field(const Vector3& p) { return 0.5 + 0.2 * p[0] + 0.15 * p[1] - 0.1 * p[2]; }
inline const Vector3 kSlope{0.2, 0.15, -0.1};

inline Light directional(const Vector3& direction) { return {LightKind::kDirectional, direction, {}, {1, 1, 1}, 1.0}; }

/// Grids and meshes of [-1, 1]^3.
class Lit : public ::testing::TestWithParam<bool> {
 protected:
  static bool is_grid() { return GetParam(); }
  static tests::Body cube(int cells, const tests::Field& field) { return make_cube(is_grid(), cells, field); }
  static RenderSettings make_settings(double tolerance) {
    RenderSettings settings = make_careful_settings(Integrator::kAntiderivative);
    settings.tolerance = tolerance;
    return settings;
  }
};

inline const auto kNameOfBody = [](const auto& test) { return test.param ? "grid" : "mesh"; };

/// Emission in the light that `light_at` finds, absorption, along a chord. With 150 steps an error of 1e-5, of 1e-4
/// where light has kinks.
inline Rgba integrate_lit(const Ray& ray, const Chord& chord, const Color& color,
                          const std::function<Illumination(const Vector3&)>& light_at, int steps = 150) {
  if (chord.length() == 0.0) return {};
  return integrate(
      chord.length(),
      [&](double u) {
        const Vector3 place = ray.at(chord.near + u * chord.length());
        return Medium{kExtinction, light_at(place).apply(color)};
      },
      steps);
}

}  // namespace tetravox::analytic
