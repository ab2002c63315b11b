#include "tetravox/environment.h"

#include "src/optics/environment_texels.h"
#include "tetravox/error.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

namespace tetravox {
namespace {

/// Length of the part of the x axis across `up` below which the y axis takes its place: sin 25 degrees.
constexpr double kLeastAcross = 0.42;

[[noreturn]] void fail(const std::string& message) {
  throw Error(ErrorCode::kInvalidArgument, "the environment " + message);
}

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length_of(const Vector3& a) { return std::hypot(a[0], a[1], a[2]); }

Vector3 normalized(const Vector3& a) {
  const double length = length_of(a);
  return {a[0] / length, a[1] / length, a[2] / length};
}

/// The part of a coordinate axis that is perpendicular to a unit vector.
Vector3 axis_across(std::size_t axis, const Vector3& up) {
  Vector3 across{};
  for (std::size_t i = 0; i < 3; ++i) across[i] = (i == axis ? 1.0 : 0.0) - up[axis] * up[i];
  return across;
}

}  // namespace

void validate_environment(const Environment& environment) {
  const bool is_cube = environment.layout == EnvironmentLayout::kCube;
  const int width = environment.width, height = environment.height;
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " texels";
  if (width < 1 || height < 1) fail("has " + size + ": each side must be at least 1");
  if (is_cube && width != height) fail("has faces of " + size + ": those of a cube are square");
  if (!is_cube && width != 2 * static_cast<long long>(height))
    fail("has " + size + ": an equirectangular picture is twice as wide as high");
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                     static_cast<std::size_t>(environment.face_count());
  if (count > kMostEnvironmentTexels)
    fail("has " + std::to_string(count) + " texels: at most " + std::to_string(kMostEnvironmentTexels) +
         " can be used, so make it smaller");
  if (environment.radiance.size() != 3 * count)
    fail("of " + size + " needs " + std::to_string(3 * count) + " numbers and has " +
         std::to_string(environment.radiance.size()));
  for (std::size_t i = 0; i < environment.radiance.size(); ++i)
    if (const float value = environment.radiance[i]; !(value >= 0.0f && value <= kLargestRadiance)) {
      const std::size_t texel = i / 3, column = texel % width, row = texel / width % height;
      fail("has a radiance of " + std::to_string(value) + " at column " + std::to_string(column) + ", row " +
           std::to_string(row) + (is_cube ? ", face " + std::to_string(texel / width / height) : std::string()) +
           ": it must be a number from 0 to 1e9");
    }
}

std::array<Vector3, 3> environment_axes(const Vector3& up, double rotation) {
  const double length = length_of(up);
  if (!(length > 0.0) || !std::isfinite(length)) fail("needs a direction that is up: three finite numbers, not all 0");
  const Vector3 top = normalized(up);
  Vector3 across = axis_across(0, top);
  if (length_of(across) < kLeastAcross) across = axis_across(1, top);
  const Vector3 right = normalized(across), ahead = cross(top, right);
  const double angle = rotation * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
  std::array<Vector3, 3> axes{right, top, ahead};
  for (std::size_t i = 0; i < 3; ++i) {
    axes[0][i] = c * right[i] + s * ahead[i];
    axes[2][i] = c * ahead[i] - s * right[i];
  }
  return axes;
}

}  // namespace tetravox

namespace tetravox::optics {

Vector3 direction_of(EnvironmentLayout layout, const FacePlace& place) {
  if (layout == EnvironmentLayout::kEquirectangular) {
    const double longitude = 2.0 * std::numbers::pi * (place.x - 0.5), colatitude = std::numbers::pi * place.y;
    const double across = std::sin(colatitude);
    return {across * std::sin(longitude), std::cos(colatitude), across * std::cos(longitude)};
  }
  // OpenGL 4.6 core profile, table 8.19.
  const double s = 2.0 * place.x - 1.0, t = 2.0 * place.y - 1.0;
  const std::array<Vector3, 6> towards{
      {{1.0, -t, -s}, {-1.0, -t, s}, {s, 1.0, t}, {s, -1.0, -t}, {s, -t, 1.0}, {-s, -t, -1.0}}};
  return normalized(towards[static_cast<std::size_t>(place.face)]);
}

double spread_of(EnvironmentLayout layout, const FacePlace& place) {
  if (layout == EnvironmentLayout::kEquirectangular) return std::sin(std::numbers::pi * place.y);
  const double s = 2.0 * place.x - 1.0, t = 2.0 * place.y - 1.0, square = 1.0 + s * s + t * t;
  return 1.0 / (square * std::sqrt(square));
}

}  // namespace tetravox::optics
