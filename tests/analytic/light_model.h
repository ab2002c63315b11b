#pragma once

/// The light at a place, as docs/methods/light.md says it, in double precision.

#include "tests/analytic/closed_form.h"
#include "tetravox/lighting.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tetravox::analytic {

inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector3 scaled(const Vector3& a, double by) { return {by * a[0], by * a[1], by * a[2]}; }
inline double norm(const Vector3& a) { return std::sqrt(dot(a, a)); }
inline Vector3 normalized(const Vector3& a) { return scaled(a, 1.0 / norm(a)); }

/// The colour that is emitted is multiplied by `diffuse`, and `specular` is added.
struct Illumination {
  Color diffuse{}, specular{};

  Color apply(const Color& color) const {
    Color lit{};
    for (int k = 0; k < 3; ++k) lit[k] = color[k] * diffuse[k] + specular[k];
    return lit;
  }
};

/// A headlight, a far and a near light.
inline Lighting make_lights() {
  Lighting lighting;
  lighting.lights = {{LightKind::kHeadlight, {}, {}, {0.5, 0.4, 0.3}, 0.8},
                     {LightKind::kDirectional, {-1.0, 2.0, -1.5}, {}, {0.2, 0.4, 0.6}, 1.0},
                     {LightKind::kPoint, {}, {2.0, -1.0, 3.0}, {0.6, 0.1, 0.1}, 0.7}};
  lighting.material = {0.2, 0.6, 0.4, 12.0};
  return lighting;
}

/// How much of a light reaches a place.
using Visibility = std::function<double(const Light&, const Vector3&)>;

/// `direction`: of the viewing ray. `strength`: 1 on surfaces, w = g^2 / (g^2 + g0^2) in the volume.
inline Illumination illuminate(const Lighting& lighting, const Vector3& direction, const Vector3& place,
                               const Vector3& gradient, double strength, const Visibility& visibility = {}) {
  const Material& material = lighting.material;
  const Vector3 to_eye = scaled(direction, -1.0);
  const Vector3 normal = norm(gradient) > 0.0 ? normalized(scaled(gradient, -1.0)) : Vector3{};
  Illumination result{{material.ambient, material.ambient, material.ambient}, {}};
  for (const Light& light : lighting.lights) {
    Vector3 to_light = to_eye;
    if (light.kind == LightKind::kDirectional) to_light = normalized(scaled(light.direction, -1.0));
    if (light.kind == LightKind::kPoint) to_light = normalized(difference(light.position, place));
    const Vector3 half = normalized(difference(to_light, direction));
    const auto facing = [&](double cosine) { return lighting.is_two_sided ? std::abs(cosine) : std::max(0.0, cosine); };
    const double cosine = dot(normal, to_light);
    double shine = std::pow(facing(dot(normal, half)), material.shininess);
    if (!lighting.is_two_sided && cosine <= 0.0) shine = 0.0;
    const double reaching = light.intensity * (visibility ? visibility(light, place) : 1.0);
    for (int k = 0; k < 3; ++k) {
      result.diffuse[k] += light.color[k] * reaching * material.diffuse * (1.0 - strength + strength * facing(cosine));
      result.specular[k] += light.color[k] * reaching * material.specular * strength * shine;
    }
  }
  return result;
}

}  // namespace tetravox::analytic
