#include "tetravox/camera.h"

#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace tetravox {
namespace {

constexpr double kLargestViewAngle = 179.9;  // as VTK's SetViewAngle

Vector3 operator+(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector3 operator-(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector3 operator*(const Vector3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Vector3& a) { return std::hypot(a[0], a[1], a[2]); }
Vector3 normalize(const Vector3& a) {
  const double l = length(a);
  return {a[0] / l, a[1] / l, a[2] / l};
}
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
bool is_finite(const Vector3& a) { return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]); }

[[noreturn]] void fail(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

/// `v` turned about the unit `axis` by `degrees`, right-handed (Rodrigues 1840).
Vector3 rotate(const Vector3& v, const Vector3& axis, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  const double c = std::cos(angle);
  return v * c + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1.0 - c));
}

/// Unit vector from the focal point towards the default camera, for a box with these edge lengths.
Vector3 default_direction(const Vector3& size) {
  // Look across the longer horizontal edge, from a little to one side, so that a long thing is seen at its full length.
  const double height = size[2] < 0.3 * std::min(size[0], size[1]) ? 1.5 : 0.9;
  if (size[1] > size[0]) return normalize({1.6, -1.0, height});
  return normalize({-1.0, -1.6, height});
}

/// Where the eye must be along one axis of the picture, and how far back, for a set of points.
struct AxisFit {
  double center = 0.0;   ///< of the eye along this axis
  double forward = 0.0;  ///< the eye's greatest coordinate along the line of sight
};

/// Fits |a - center| <= slope * (z - forward) for all points, with `forward` as large as it can be.
AxisFit fit_axis(const std::array<Vector3, 8>& points, const Vector3& axis, const Vector3& view_direction,
                 double slope) {
  double upper = -HUGE_VAL, lower = -HUGE_VAL;
  for (const Vector3& point : points) {
    const double a = dot(point, axis), z = dot(point, view_direction);
    upper = std::max(upper, a - slope * z);
    lower = std::max(lower, -a - slope * z);
  }
  return {0.5 * (upper - lower), -(upper + lower) / (2.0 * slope)};
}

}  // namespace

void validate_camera(const Camera& camera) {
  if (!is_finite(camera.position)) fail("camera position: not a finite point");
  if (!is_finite(camera.focal_point)) fail("camera focal_point: not a finite point");
  if (!is_finite(camera.view_up)) fail("camera view_up: not a finite vector");
  const Vector3 forward = camera.focal_point - camera.position;
  if (!is_finite(forward) || !(length(forward) > 0.0) || !std::isfinite(length(forward)))
    fail("camera position and focal_point are the same, or too far apart; move one of them");
  if (!(length(camera.view_up) > 0.0) || !std::isfinite(length(camera.view_up)))
    fail("camera view_up has no length; give a direction, for example 0,0,1");
  if (length(cross(normalize(forward), normalize(camera.view_up))) < 1e-9)
    fail("camera view_up is parallel to the line of sight; choose another direction");
  if (camera.parallel_scale) {
    if (!std::isfinite(*camera.parallel_scale) || !(*camera.parallel_scale > 0.0))
      fail("camera parallel_scale must be above 0 (half the height of the picture, world units)");
  } else if (!(camera.view_angle > 0.0 && camera.view_angle < 180.0)) {
    fail("camera view_angle must be between 0 and 180 degrees, both excluded");
  }
}

Camera make_default_camera(const std::array<ValueRange, 3>& bounds, double aspect) {
  constexpr double kMargin = 0.05;  // of the picture's half height and half width
  if (!std::isfinite(aspect) || !(aspect > 0.0)) fail("the picture's aspect (width / height) must be above 0");
  Vector3 center{}, half{};
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(bounds[i].min) || !std::isfinite(bounds[i].max) || bounds[i].min > bounds[i].max)
      fail("bounds along axis " + std::to_string(i) + " are not a finite range");
    center[i] = 0.5 * bounds[i].min + 0.5 * bounds[i].max;
    half[i] = 0.5 * bounds[i].max - 0.5 * bounds[i].min;
  }
  // Give a single point a size, such that its camera stands apart from it.
  const double largest = std::max({half[0], half[1], half[2]});
  const double smallest_size = 1e-9 * length(center);
  if (!(largest > smallest_size)) half.fill(smallest_size > 0.0 ? 1e3 * smallest_size : 0.5);

  Camera camera;
  camera.view_up = {0, 0, 1};
  const Vector3 forward = default_direction(half) * -1.0;
  const Vector3 right = normalize(cross(forward, camera.view_up));
  const Vector3 up = cross(right, forward);

  // Fit all corners, about the centre to keep digits where the data is far from the origin.
  std::array<Vector3, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners[i] = {(i & 1) ? half[0] : -half[0], (i & 2) ? half[1] : -half[1], (i & 4) ? half[2] : -half[2]};
  const double slope = (1.0 - kMargin) * std::tan(0.5 * camera.view_angle * std::numbers::pi / 180.0);
  const AxisFit vertical = fit_axis(corners, up, forward, slope);
  const AxisFit horizontal = fit_axis(corners, right, forward, slope * aspect);
  const double depth = std::min(vertical.forward, horizontal.forward);
  const Vector3 offset = right * horizontal.center + up * vertical.center;
  camera.position = center + (offset + forward * depth);
  camera.focal_point = center + offset;
  return camera;
}

Camera rotate_camera(const Camera& camera, double azimuth, double elevation) {
  validate_camera(camera);
  if (!std::isfinite(azimuth) || !std::isfinite(elevation)) fail("camera azimuth and elevation must be finite degrees");
  Vector3 arm = rotate(camera.position - camera.focal_point, normalize(camera.view_up), azimuth);
  const Vector3 left = normalize(cross(arm, camera.view_up));
  arm = rotate(arm, left, elevation);
  Camera rotated = camera;
  rotated.position = camera.focal_point + arm;
  return rotated;
}

Camera zoom_camera(const Camera& camera, double factor) {
  if (!std::isfinite(factor) || !(factor > 0.0)) fail("camera zoom must be above 0");
  Camera zoomed = camera;
  if (camera.parallel_scale)
    zoomed.parallel_scale = *camera.parallel_scale / factor;
  else
    zoomed.view_angle = std::min(camera.view_angle / factor, kLargestViewAngle);
  return zoomed;
}

}  // namespace tetravox
