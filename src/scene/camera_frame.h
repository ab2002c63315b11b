#pragma once

/// The mesh and the rays in the camera's frame.
///
/// Camera frame: x to the right, y up, z along the view; local length units; origin that of the mesh (not the eye), so
/// that a distant eye costs no precision. Pixel (column, row) looks along x = column_offset + column_slope * z and
/// likewise y; slopes are 0 for an orthographic camera.

#include "tetravox/camera.h"
#include "tetravox/image.h"
#include "tetravox/mesh.h"

#include <array>
#include <memory>
#include <vector>

namespace tetravox::scene {

/// The camera in local units.
struct CameraFrame {
  std::array<Vector3, 3> axes{};  ///< right, up, forward: unit vectors, world directions
  Vector3 eye{};                  ///< in the camera frame
  bool is_orthographic = false;
  double pixel_step = 0.0;  ///< slope (perspective) or distance (orthographic) between neighbouring pixels
  int width = 0, height = 0;
};

/// `origin`: world position of the local origin.
CameraFrame make_camera_frame(const Vector3& origin, double world_per_local, const Camera& camera, int width,
                              int height);
CameraFrame make_camera_frame(const PreparedMesh& mesh, const Camera& camera, int width, int height);

/// Rows of a 3 x 4 matrix: places of the camera frame -> world. `origin`: as above.
std::array<double, 12> world_from_camera(const CameraFrame& frame, const Vector3& origin, double world_per_local);

/// Turns `Image::depth` from depths of the camera frame into world distances from the eye's plane.
void measure_depth(const CameraFrame& frame, double world_per_local, Image& image);

/// Rays of a frame. Camera frame: x to the right, y up, z along the view, local length units, origin that of the mesh.
/// The ray of pixel (column, row) is x = column_offset + column_slope * z, y = row_offset + row_slope * z.
struct RayGrid {
  int width = 0, height = 0;
  const float* column_offset = nullptr;  ///< [width], padded to whole vectors; likewise the other three
  const float* column_slope = nullptr;
  const float* row_offset = nullptr;  ///< [height]
  const float* row_slope = nullptr;
  float z_near = 0.0f;           ///< rays start at this z: the eye, or the plane of an orthographic camera
  float world_per_local = 1.0f;  ///< length
};

/// The arrays that a RayGrid views.
struct Rays {
  std::vector<float> column_offset, column_slope, row_offset, row_slope;
  RayGrid grid;
};

Rays make_rays(const CameraFrame& frame, double world_per_local);

/// Vertices in the camera frame, [vertices][4]; every element is written once.
void transform_vertices(const PreparedMesh& mesh, const CameraFrame& frame, float* vertices);

}  // namespace tetravox::scene
