#include "src/scene/camera_frame.h"

#include "src/support/threads.h"

#include <cmath>
#include <numbers>

namespace tetravox::scene {
namespace {

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector3 normalized(const Vector3& a) {
  const double length = std::hypot(a[0], a[1], a[2]);
  return {a[0] / length, a[1] / length, a[2] / length};
}

}  // namespace

CameraFrame make_camera_frame(const Vector3& origin, double world_per_local, const Camera& camera, int width,
                              int height) {
  CameraFrame frame;
  Vector3 view{}, eye{};
  for (int i = 0; i < 3; ++i) {
    view[i] = camera.focal_point[i] - camera.position[i];
    eye[i] = (camera.position[i] - origin[i]) / world_per_local;
  }
  const Vector3 forward = normalized(view);
  const Vector3 right = normalized(cross(forward, camera.view_up));
  frame.axes = {right, cross(right, forward), forward};
  for (int i = 0; i < 3; ++i) frame.eye[i] = dot(frame.axes[i], eye);
  frame.is_orthographic = camera.parallel_scale.has_value();
  frame.pixel_step = frame.is_orthographic ? 2.0 * *camera.parallel_scale / world_per_local / height
                                           : 2.0 * std::tan(camera.view_angle * std::numbers::pi / 360.0) / height;
  frame.width = width;
  frame.height = height;
  return frame;
}

CameraFrame make_camera_frame(const PreparedMesh& mesh, const Camera& camera, int width, int height) {
  return make_camera_frame(mesh.origin, mesh.world_per_local, camera, width, height);
}

std::array<double, 12> world_from_camera(const CameraFrame& frame, const Vector3& origin, double world_per_local) {
  std::array<double, 12> matrix{};
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) matrix[4 * row + axis] = frame.axes[axis][row] * world_per_local;
    matrix[4 * row + 3] = origin[row];
  }
  return matrix;
}

void measure_depth(const CameraFrame& frame, double world_per_local, Image& image) {
  for (float& depth : image.depth) depth = static_cast<float>((depth - frame.eye[2]) * world_per_local);
}

Rays make_rays(const CameraFrame& frame, double world_per_local) {
  constexpr std::size_t kPadding = 16;  // kernels load whole vectors
  Rays rays;
  const auto fill = [&](int count, double eye, double sign, std::vector<float>& offsets, std::vector<float>& slopes) {
    offsets.assign(static_cast<std::size_t>(count) + kPadding, 0.0f);
    slopes.assign(static_cast<std::size_t>(count) + kPadding, 0.0f);
    for (int i = 0; i < count; ++i) {
      const double at = sign * (i + 0.5 - 0.5 * count) * frame.pixel_step;
      slopes[i] = frame.is_orthographic ? 0.0f : static_cast<float>(at);
      // The offset goes with the slope as rounded, so that every ray of a perspective passes through the eye.
      offsets[i] =
          static_cast<float>(frame.is_orthographic ? eye + at : eye - static_cast<double>(slopes[i]) * frame.eye[2]);
    }
  };
  fill(frame.width, frame.eye[0], 1.0, rays.column_offset, rays.column_slope);
  fill(frame.height, frame.eye[1], -1.0, rays.row_offset, rays.row_slope);
  rays.grid = {frame.width,
               frame.height,
               rays.column_offset.data(),
               rays.column_slope.data(),
               rays.row_offset.data(),
               rays.row_slope.data(),
               static_cast<float>(frame.eye[2]),
               static_cast<float>(world_per_local)};
  return rays;
}

void transform_vertices(const PreparedMesh& mesh, const CameraFrame& frame, float* vertices) {
  support::parallel_chunks(mesh.vertices.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vertex& vertex = mesh.vertices[i];
      const Vector3 local{vertex.x, vertex.y, vertex.z};
      float* out = vertices + 4 * i;
      for (int axis = 0; axis < 3; ++axis) out[axis] = static_cast<float>(dot(frame.axes[axis], local));
      out[3] = vertex.scalar;
    }
  });
}

}  // namespace tetravox::scene
