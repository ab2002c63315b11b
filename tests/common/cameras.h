#pragma once

/// Cameras that look at a box in ways that matter.

#include "tetravox/camera.h"

#include <array>
#include <string>
#include <vector>

namespace tetravox::tests {

struct NamedCamera {
  std::string name;
  Camera camera;
};

/// "outside" (perspective), "orthographic", "inside" (wide angle, the eye a quarter off the middle), "near" (the eye
/// just outside, part of the mesh behind it), "plane" (orthographic, the camera's plane cuts the mesh).
inline std::vector<NamedCamera> make_cameras(const std::array<ValueRange, 3>& bounds) {
  const auto at = [&](double x, double y, double z) {
    const double u[3] = {x, y, z};
    Vector3 p{};
    for (int k = 0; k < 3; ++k)
      p[k] = 0.5 * (bounds[k].min + bounds[k].max) + 0.5 * u[k] * (bounds[k].max - bounds[k].min);
    return p;
  };
  const double height = bounds[2].max - bounds[2].min;
  Camera outside;
  outside.position = at(3.1, -4.3, 2.7);
  outside.focal_point = at(0.05, -0.03, 0.02);
  outside.view_up = {0, 0, 1};
  outside.view_angle = 35.0;
  Camera orthographic = outside;
  orthographic.position = at(-2.6, 3.4, 3.9);
  orthographic.parallel_scale = 0.85 * height;
  Camera inside = outside;
  inside.position = at(0.27, -0.23, 0.19);
  inside.focal_point = at(-0.9, 0.7, 0.1);
  inside.view_angle = 80.0;
  Camera near = outside;
  near.position = at(0.95, 1.05, 0.4);
  near.focal_point = at(-0.8, -0.9, -0.3);
  near.view_angle = 95.0;
  Camera plane = orthographic;
  plane.position = at(0.11, -0.07, 0.13);
  plane.focal_point = at(1.0, 0.6, 0.4);
  return {{"outside", outside}, {"orthographic", orthographic}, {"inside", inside}, {"near", near}, {"plane", plane}};
}

}  // namespace tetravox::tests
