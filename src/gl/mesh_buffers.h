#pragma once

/// A prepared mesh on the device, as a camera sees it.

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/resources.h"
#include "src/scene/camera_frame.h"
#include "src/scene/eye_cells.h"
#include "tetravox/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::gl {

/// With the context current.
class MeshBuffers {
 public:
  /// @throws Error (kUnsupported) where the device cannot hold the mesh.
  MeshBuffers(const PreparedMesh& mesh, const Limits& limits);

  /// Moves the vertices into the camera's frame, and finds the cells around the eye, which may move it.
  scene::CameraFrame see(const Camera& camera, int width, int height);
  /// Whether rays of that frame may walk behind the eye: one in a cell, or the plane of an orthographic camera.
  bool is_behind_eye(const scene::CameraFrame& frame) const;
  /// Of the last `see`: [vertices][4] camera frame, stored scalar.
  std::span<const float> seen() const { return seen_; }
  void bind() const;
  /// Vertices, faces and the first of those around the eye.
  WalkBlock describe() const;
  std::uint64_t bytes() const;

 private:
  scene::SeenMesh seen_mesh() const;

  const PreparedMesh& mesh_;
  std::vector<float> seen_;  ///< [vertices][4]
  std::size_t face_count_ = 0;
  BufferTexture vertices_, cells_, faces_, cell_scalars_;
};

}  // namespace tetravox::gl
