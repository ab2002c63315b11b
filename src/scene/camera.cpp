#include "tetravox/camera.h"

#include "src/scene/camera_fit.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace tetravox {
namespace {

constexpr double kLargestViewAngle = 179.9;  // as VTK's SetViewAngle
constexpr double kViewAngle = 30.0;          // of default cameras, degrees
constexpr double kMargin = 0.05;             // around what is fitted, of half the picture
constexpr Vector3 kUp{0, 0, 1};

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
  // Look down steeper on flat things.
  const double height = size[2] < 0.3 * std::min(size[0], size[1]) ? 1.9 : 0.9;
  if (size[1] > size[0]) return normalize({1.6, -1.0, height});
  return normalize({-1.0, -1.6, height});
}

}  // namespace

bool looks_along_up(const Camera& camera) {
  const Vector3 forward = camera.focal_point - camera.position;
  return length(cross(normalize(forward), normalize(camera.view_up))) < 1e-9;
}

void validate_camera(const Camera& camera) {
  if (!is_finite(camera.position)) fail("camera position: not a finite point");
  if (!is_finite(camera.focal_point)) fail("camera focal_point: not a finite point");
  if (!is_finite(camera.view_up)) fail("camera view_up: not a finite vector");
  const Vector3 forward = camera.focal_point - camera.position;
  if (!is_finite(forward) || !(length(forward) > 0.0) || !std::isfinite(length(forward)))
    fail("camera position and focal_point are the same, or too far apart; move one of them");
  if (!(length(camera.view_up) > 0.0) || !std::isfinite(length(camera.view_up)))
    fail("camera view_up has no length; give a direction, for example 0,0,1");
  if (looks_along_up(camera))
    fail("camera view_up is parallel to the line of sight: choose another direction (--camera-view-up)");
  if (camera.parallel_scale) {
    if (!std::isfinite(*camera.parallel_scale) || !(*camera.parallel_scale > 0.0))
      fail("camera parallel_scale must be above 0 (half the height of the picture, world units)");
  } else if (!(camera.view_angle > 0.0 && camera.view_angle < 180.0)) {
    fail("camera view_angle must be between 0 and 180 degrees, both excluded");
  }
}

namespace scene {

CameraFit::CameraFit(const std::array<ValueRange, 3>& bounds, double aspect) {
  if (!std::isfinite(aspect) || !(aspect > 0.0)) fail("the picture's aspect (width / height) must be above 0");
  Vector3 half{};
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(bounds[i].min) || !std::isfinite(bounds[i].max) || bounds[i].min > bounds[i].max)
      fail("bounds along axis " + std::to_string(i) + " are not a finite range");
    center_[i] = 0.5 * bounds[i].min + 0.5 * bounds[i].max;
    half[i] = 0.5 * bounds[i].max - 0.5 * bounds[i].min;
  }
  // Give a single point a size, such that its camera stands apart from it.
  const double largest = std::max({half[0], half[1], half[2]});
  const double smallest = 1e-9 * length(center_);
  if (!(largest > smallest)) half.fill(smallest > 0.0 ? 1e3 * smallest : 0.5);
  is_point_ = !(largest > smallest);
  half_ = half;

  forward_ = default_direction(half) * -1.0;
  right_ = normalize(cross(forward_, kUp));
  up_ = cross(right_, forward_);
  vertical_.slope = (1.0 - kMargin) * std::tan(0.5 * kViewAngle * std::numbers::pi / 180.0);
  horizontal_.slope = vertical_.slope * aspect;
}

void CameraFit::add_corners() {
  for (int i = 0; i < 8; ++i)
    add_offset({(i & 1) ? half_[0] : -half_[0], (i & 2) ? half_[1] : -half_[1], (i & 4) ? half_[2] : -half_[2]});
}

void CameraFit::add_point(const Vector3& point) { add_offset(point - center_); }

void CameraFit::add_offset(const Vector3& offset) {
  const double z = dot(offset, forward_);
  horizontal_.add(dot(offset, right_), z);
  vertical_.add(dot(offset, up_), z);
}

void CameraFit::Axis::add(double a, double z) {
  upper = std::max(upper, a - slope * z);
  lower = std::max(lower, -a - slope * z);
}

Camera CameraFit::camera() {
  if (is_point_ || !(vertical_.upper > -HUGE_VAL)) add_corners();
  const double depth = std::min(vertical_.forward(), horizontal_.forward());
  const Vector3 offset = right_ * horizontal_.center() + up_ * vertical_.center();
  Camera camera;
  camera.view_up = kUp;
  camera.view_angle = kViewAngle;
  camera.position = center_ + (offset + forward_ * depth);
  camera.focal_point = center_ + offset;
  return camera;
}

}  // namespace scene

Camera make_default_camera(const std::array<ValueRange, 3>& bounds, double aspect) {
  scene::CameraFit fit(bounds, aspect);
  fit.add_corners();
  return fit.camera();
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
