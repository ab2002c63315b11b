#include "tests/analytic/closed_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace tetravox::analytic {
namespace {

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector3 normalized(Vector3 v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  for (double& component : v) component /= length;
  return v;
}

Vector3 sum(const Vector3& a, double u, const Vector3& b, double v, const Vector3& c) {
  return {a[0] + u * b[0] + v * c[0], a[1] + u * b[1] + v * c[1], a[2] + u * b[2] + v * c[2]};
}

}  // namespace

Vector3 Ray::at(double t) const { return sum(origin, t, direction, 0.0, direction); }

Ray make_ray(const Camera& camera, int width, int height, int x, int y) {
  const Vector3 forward = normalized(sum(camera.focal_point, -1.0, camera.position, 0.0, camera.position));
  const Vector3 right = normalized(cross(forward, camera.view_up));
  const Vector3 up = cross(right, forward);
  const double half =
      camera.parallel_scale ? *camera.parallel_scale : std::tan(camera.view_angle * std::numbers::pi / 360.0);
  const double u = half * (2.0 * x + 1.0 - width) / height;
  const double v = half * (height - 2.0 * y - 1.0) / height;
  if (camera.parallel_scale) return {sum(camera.position, u, right, v, up), forward};
  return {camera.position, normalized(sum(forward, u, right, v, up))};
}

Chord intersect_box(const Ray& ray, const Vector3& lower, const Vector3& upper) {
  Chord chord{0.0, std::numeric_limits<double>::infinity()};
  for (int k = 0; k < 3; ++k) {
    double a = (lower[k] - ray.origin[k]) / ray.direction[k];
    double b = (upper[k] - ray.origin[k]) / ray.direction[k];
    if (a > b) std::swap(a, b);
    chord.near = std::max(chord.near, a);
    chord.far = std::min(chord.far, b);
  }
  return chord;
}

Rgba fill(const Color& color, double optical_depth) {
  const double alpha = -std::expm1(-optical_depth);
  return {color[0] * alpha, color[1] * alpha, color[2] * alpha, alpha};
}

Rgba over(const Rgba& front, const Rgba& back) {
  Rgba result{};
  for (int k = 0; k < 4; ++k) result[k] = front[k] + (1.0 - front[3]) * back[k];
  return result;
}

Rgba integrate(double length, const std::function<Medium(double)>& medium_at, int steps) {
  Rgba result{};
  double depth = 0.0;
  for (int i = 0; i < steps; ++i) {
    const Medium medium = medium_at((i + 0.5) / steps);
    const double step = medium.extinction * length / steps;
    const double weight = std::exp(-depth) * -std::expm1(-step);
    for (int k = 0; k < 3; ++k) result[k] += weight * medium.color[k];
    depth += step;
  }
  result[3] = -std::expm1(-depth);
  return result;
}

::testing::AssertionResult shows(const Image& image, const Camera& camera,
                                 const std::function<Rgba(const Ray&)>& expected, const Tolerance& tolerance) {
  int covered = 0, failures = 0;
  double worst = 1.0;
  std::ostringstream message;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Rgba wanted = expected(make_ray(camera, image.width, image.height, x, y));
      covered += wanted[3] > 0.0;
      for (int k = 0; k < 4; ++k) {
        const double excess =
            std::abs(image.pixel(x, y)[k] - wanted[k]) / (k < 3 ? tolerance.color : tolerance.opacity);
        if (excess <= 1.0) continue;  // false for what is not a number
        ++failures;
        if (excess <= worst) continue;
        worst = excess;
        message.str("");
        message << "; the worst: pixel (" << x << ", " << y << ") channel " << k << " is " << image.pixel(x, y)[k]
                << ", not " << wanted[k] << ", off by " << image.pixel(x, y)[k] - wanted[k];
      }
    }
  }
  if (failures > 0) return ::testing::AssertionFailure() << failures << " values are off" << message.str();
  if (10 * covered >= image.width * image.height) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "only " << covered << " pixels show anything: a weak test";
}

std::vector<std::pair<const char*, Camera>> standard_cameras() {
  Camera perspective;
  perspective.position = {3.1, -4.3, 2.7};
  perspective.focal_point = {0.05, -0.02, 0.01};
  perspective.view_up = {0, 0, 1};
  perspective.view_angle = 33.0;
  Camera orthographic = perspective;
  orthographic.position = {-2.9, 3.7, 4.1};
  orthographic.parallel_scale = 1.7;
  Camera inside;
  inside.position = {0.31, -0.27, 0.13};
  inside.focal_point = {-0.9, 0.4, 0.2};
  inside.view_up = {0.1, 0.2, 1};
  inside.view_angle = 75.0;
  return {{"perspective", perspective}, {"orthographic", orthographic}, {"inside", inside}};
}

}  // namespace tetravox::analytic
