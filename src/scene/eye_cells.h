#pragma once

/// The cells around an eye that is inside the mesh.

#include "src/scene/camera_frame.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::scene {

/// Vertices and cells as the camera sees them.
struct SeenMesh {
  const float* vertices = nullptr;  ///< [vertices][4] x, y, z in the camera frame, stored scalar
  std::uint32_t last_vertex = 0;
  const TetrahedronLinks* cells = nullptr;
};

/// The four faces of every cell that holds the eye of a perspective camera (several where cells overlap), oriented like
/// the boundary; none where the eye is outside. Walks along the view axis from every boundary face behind the eye.
///
/// An eye on a face, edge or vertex would belong to many cells, each of which sees a part of the picture: it is moved
/// into one of them, by some millionths of the mesh's size, so `frame.eye` may change.
std::vector<BoundaryFace> find_eye_cell_faces(const SeenMesh& mesh, std::span<const BoundaryFace> boundary,
                                              std::size_t cell_count, CameraFrame& frame);

/// Whether rays may pass cells before they come to the eye, or to the plane of an orthographic camera.
/// `is_in_cell`: whether there are faces of `find_eye_cell_faces`.
bool reaches_behind_eye(const SeenMesh& mesh, const CameraFrame& frame, bool is_in_cell);

}  // namespace tetravox::scene
