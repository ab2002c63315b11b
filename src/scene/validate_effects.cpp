/// What light, surfaces and clipping may say.

#include "tetravox/clipping.h"
#include "tetravox/error.h"
#include "tetravox/isosurface.h"
#include "tetravox/lighting.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <variant>

namespace tetravox {
namespace {

[[noreturn]] void fail(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

bool is_finite(const Vector3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

void require_number(const std::string& name, double value, double least, double most) {
  if (value >= least && value <= most) return;
  const auto text = [](double bound) { return std::to_string(static_cast<long long>(bound)); };
  const bool is_bounded = most <= 1e6;
  fail(name + ": expected a number from " + text(least) + (is_bounded ? " to " + text(most) : " up"));
}

void require_direction(const std::string& name, const Vector3& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  if (!(length > 0.0) || !std::isfinite(length)) fail(name + ": expected three finite numbers, not all 0");
}

void require_place(const std::string& name, const Vector3& v) {
  if (!is_finite(v)) fail(name + ": expected three finite numbers");
}

void require_color(const std::string& name, const Color& color) {
  for (const double channel : color)
    if (!(channel >= 0.0 && channel <= 1.0)) fail(name + ": colours are three numbers in [0, 1]");
}

void validate(const Light& light, const std::string& name) {
  require_color(name + ", color", light.color);
  require_number(name + ", intensity", light.intensity, 0.0, HUGE_VAL);
  if (!std::isfinite(light.intensity)) fail(name + ", intensity: expected a finite number");
  if (light.kind == LightKind::kDirectional) require_direction(name + ", direction", light.direction);
  if (light.kind == LightKind::kPoint) require_place(name + ", position", light.position);
}

void validate(const EnvironmentLight& light) {
  if (light.file.empty()) fail("environment, file: expected a name");
  require_number("environment, intensity", light.intensity, 0.0, 1e6);
  if (!std::isfinite(light.rotation)) fail("environment, rotation: expected a finite number of degrees");
  require_direction("environment, up", light.up);
}

void validate(const ClipPlane& plane, const std::string& name) {
  require_place(name + ", origin", plane.origin);
  require_direction(name + ", normal", plane.normal);
}

void validate(const ClipBox& box, const std::string& name) {
  for (const ValueRange& range : box.bounds)
    if (!(range.min < range.max) || !std::isfinite(range.min) || !std::isfinite(range.max))
      fail(name + ", box: expected finite bounds that ascend along each axis");
}

void validate(const ClipSphere& sphere, const std::string& name) {
  require_place(name + ", center", sphere.center);
  if (!(sphere.radius > 0.0) || !std::isfinite(sphere.radius)) fail(name + ", radius: expected a number above 0");
}

void validate(const ClipVolume& volume, const std::string& name) {
  if (!std::isfinite(volume.value)) fail(name + ", value: expected a finite number");
}

}  // namespace

void validate_lighting(const Lighting& lighting) {
  for (std::size_t i = 0; i < lighting.lights.size(); ++i) validate(lighting.lights[i], "light " + std::to_string(i));
  if (lighting.environment) validate(*lighting.environment);
  const Material& material = lighting.material;
  require_number("material, ambient", material.ambient, 0.0, 1.0);
  require_number("material, diffuse", material.diffuse, 0.0, 1.0);
  require_number("material, specular", material.specular, 0.0, 1.0);
  require_number("material, shininess", material.shininess, 1.0, 1000.0);
  require_number("gradient threshold", lighting.gradient_threshold, 0.0, 1e30);
  require_number("shadow resolution", lighting.shadow_resolution, 8, 512);
  require_number("translucency", lighting.translucency, 0.0, 1.0);
  require_number("translucency angle", lighting.translucency_angle, 0.0, 80.0);
  require_number("ambient occlusion", lighting.ambient_occlusion, 0, 1024);
}

void validate_isosurfaces(const std::vector<Isosurface>& surfaces) {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const std::string name = "surface " + std::to_string(i);
    if (!std::isfinite(surfaces[i].value)) fail(name + ", value: expected a finite number");
    require_color(name + ", front colour", surfaces[i].front_color);
    require_color(name + ", back colour", surfaces[i].back_color);
    require_number(name + ", opacity", surfaces[i].opacity, 0.0, 1.0);
  }
}

void validate_clipping(const Clipping& clipping) {
  for (std::size_t i = 0; i < clipping.shapes.size(); ++i)
    std::visit([&](const auto& shape) { validate(shape, "clip shape " + std::to_string(i)); },
               clipping.shapes[i].shape);
}

}  // namespace tetravox
