#pragma once

/// Where a mesh is seen from, in its local frame and in double precision.

#include "tetravox/camera.h"
#include "tetravox/mesh.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace tetravox::sort {

inline Vector3 operator+(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector3 operator-(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector3 operator*(const Vector3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Sum of magnitudes.
inline double norm1(const Vector3& a) { return std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]); }
inline double norm(const Vector3& a) { return std::sqrt(dot(a, a)); }

inline Vector3 position_of(const Vertex& v) { return {v.x, v.y, v.z}; }

/// The eye, or where there is none the direction of all rays. Everything that an order depends on.
struct ViewPoint {
  bool is_orthographic = false;
  Vector3 eye{};      ///< perspective
  Vector3 forward{};  ///< orthographic: unit length

  bool operator==(const ViewPoint&) const = default;

  /// From a place towards the eye; of any length.
  Vector3 towards_eye(const Vector3& place) const { return is_orthographic ? forward * -1.0 : eye - place; }
  /// Grows along every ray. Perspective: the squared distance, which orders like the distance.
  double depth_key(const Vector3& place) const {
    if (is_orthographic) return dot(forward, place);
    const Vector3 arm = place - eye;
    return dot(arm, arm);
  }
};

/// @throws Error (kInvalidArgument) where the camera defines no view.
ViewPoint make_view_point(const PreparedMesh& mesh, const Camera& camera);

/// The rays through the middles of pixels: from `origin(column, row)` along `direction(column, row)`, which has length
/// 1 along the line of sight.
struct PixelRays {
  Vector3 eye{};  ///< local; orthographic: somewhere in the plane of the camera
  Vector3 right{}, up{}, forward{};
  bool is_orthographic = false;
  double step = 0.0;  ///< between pixels: slope, or local length
  int width = 0, height = 0;

  double column_offset(double column) const { return (column + 0.5 - 0.5 * width) * step; }
  double row_offset(double row) const { return (0.5 * height - row - 0.5) * step; }
  Vector3 origin(int column, int row) const {
    return is_orthographic ? eye + right * column_offset(column) + up * row_offset(row) : eye;
  }
  Vector3 direction(int column, int row) const {
    return is_orthographic ? forward : forward + right * column_offset(column) + up * row_offset(row);
  }
};

PixelRays make_pixel_rays(const PreparedMesh& mesh, const Camera& camera, int width, int height);

}  // namespace tetravox::sort
