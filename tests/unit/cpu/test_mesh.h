#pragma once

/// What the tests of src/cpu share: a prepared embedded mesh and its frame for a camera.

#include "src/cpu/kernels/kernels.h"
#include "src/scene/camera_frame.h"
#include "tetravox/mesh.h"

#include <memory>
#include <string>
#include <vector>

namespace tetravox::cpu {

inline PreparedMesh make_test_mesh(const std::string& name) { return prepare_mesh(make_builtin(name).mesh); }

struct TestFrame {
  scene::CameraFrame camera;
  std::vector<float> vertices;
  FrameMesh mesh;
  scene::Rays rays;
};

inline TestFrame make_test_frame(const PreparedMesh& mesh, const Camera& camera, int width, int height) {
  TestFrame frame;
  frame.camera = scene::make_camera_frame(mesh, camera, width, height);
  frame.vertices.resize(4 * mesh.vertices.size());
  scene::transform_vertices(mesh, frame.camera, frame.vertices.data());
  frame.mesh = {frame.vertices.data(), static_cast<std::uint32_t>(mesh.vertices.size() - 1), mesh.cells.data(), nullptr,
                mesh.boundary.data()};
  frame.rays = scene::make_rays(frame.camera, mesh.world_per_local);
  return frame;
}

}  // namespace tetravox::cpu
