#include "tetravox/scene.h"

#include <algorithm>
#include <cmath>

namespace tetravox {
namespace {

constexpr int kDefaultBinCount = 512;  // of the histogram behind the default function

double diagonal(const std::array<ValueRange, 3>& bounds) {
  return std::hypot(bounds[0].max - bounds[0].min, bounds[1].max - bounds[1].min, bounds[2].max - bounds[2].min);
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
  completed.camera = scene.camera ? *scene.camera : make_default_camera(mesh.bounds, aspect);
  return completed;
}

}  // namespace tetravox
