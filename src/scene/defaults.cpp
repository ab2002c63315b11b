#include "src/scene/camera_fit.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cmath>

namespace tetravox {
namespace {

constexpr int kDefaultBinCount = 512;  // of the histogram behind the default function

double diagonal(const std::array<ValueRange, 3>& bounds) {
  return std::hypot(bounds[0].max - bounds[0].min, bounds[1].max - bounds[1].min, bounds[2].max - bounds[2].min);
}

/// The default camera, fitted to the mesh itself: closer than to its bounds.
Camera make_camera(const PreparedMesh& mesh, double aspect) {
  scene::CameraFit fit(mesh.bounds, aspect);
  for (const BoundaryFace& face : mesh.boundary)
    for (const std::uint32_t id : face.vertices) {
      const Vertex& v = mesh.vertices[id];
      fit.add_point({mesh.origin[0] + mesh.world_per_local * v.x, mesh.origin[1] + mesh.world_per_local * v.y,
                     mesh.origin[2] + mesh.world_per_local * v.z});
    }
  return fit.camera();
}

}  // namespace

CompletedScene complete_scene(const Scene& scene, const PreparedMesh& mesh) {
  CompletedScene completed;
  completed.transfer_function = scene.transfer_function
                                    ? *scene.transfer_function
                                    : make_default_transfer_function(make_histogram(mesh, kDefaultBinCount));
  const double unit_distance = diagonal(mesh.bounds) / 100.0;
  completed.optical_function =
      make_optical_function(completed.transfer_function, unit_distance > 0.0 ? unit_distance : 1.0);
  const double aspect = static_cast<double>(scene.settings.width) / scene.settings.height;
  completed.camera = scene.camera ? *scene.camera : make_camera(mesh, aspect);
  return completed;
}

}  // namespace tetravox
