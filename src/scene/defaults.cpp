#include "src/scene/camera_fit.h"
#include "src/scene/histogram_limits.h"
#include "src/scene/shown_bricks.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tetravox {
namespace {

constexpr int kDefaultBinCount = 512;     // of the histogram behind the default function
constexpr double kFaintestShown = 0.015;  // optical depth of a hundredth of the diagonal that counts as shown

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

/// Tells which values a function shows.
class ShownValues {
 public:
  ShownValues(const OpticalFunction& function, double least_extinction)
      : function_(function), least_(least_extinction) {
    std::size_t shown = 0;
    for (const OpticalPoint& point : function.points)
      shown_before_.push_back(shown += point.extinction > least_extinction);
  }
  /// Whether a value in [min, max] is shown: at its ends, or at a control point inside.
  bool any(double min, double max) const {
    if (eval_optical_function(function_, min).extinction > least_ ||
        eval_optical_function(function_, max).extinction > least_)
      return true;
    return count_below(max) > count_below(min);
  }

 private:
  std::size_t count_below(double value) const {
    const auto end = std::upper_bound(function_.points.begin(), function_.points.end(), value,
                                      [](double a, const OpticalPoint& b) { return a < b.value; });
    const auto points = static_cast<std::size_t>(end - function_.points.begin());
    return points > 0 ? shown_before_[points - 1] : 0;
  }

  const OpticalFunction& function_;
  double least_;
  std::vector<std::size_t> shown_before_;
};

/// The default camera, fitted to the bricks that the function shows.
Camera make_camera(const PreparedGrid& grid, const OpticalFunction& function, double aspect) {
  const double unit = scene::diagonal_of(grid.bounds) / 100.0;
  const ShownValues shown(function, unit > 0.0 ? kFaintestShown / unit : 0.0);
  const scene::WantsBrick wants = [&](float min, float max) {
    return shown.any(grid.scalar_offset + min * grid.scalar_scale, grid.scalar_offset + max * grid.scalar_scale);
  };
  const auto bounds = scene::bounds_of_bricks(grid, wants);
  scene::CameraFit fit(bounds.value_or(grid.bounds), aspect);
  if (bounds) scene::visit_hull(grid, wants, [&](const Vector3& point) { fit.add_point(point); });
  return fit.camera();
}

/// What is the same for meshes and grids; `make_camera(function, aspect)` fits a view.
template <class Prepared, class MakeCamera>
CompletedScene complete(const Scene& scene, const Prepared& prepared, const MakeCamera& make_camera) {
  CompletedScene completed;
  completed.transfer_function = scene.transfer_function
                                    ? *scene.transfer_function
                                    : make_default_transfer_function(make_histogram(prepared, kDefaultBinCount));
  const double unit_distance = scene::diagonal_of(prepared.bounds) / 100.0;
  completed.optical_function =
      make_optical_function(completed.transfer_function, unit_distance > 0.0 ? unit_distance : 1.0);
  const double aspect = static_cast<double>(scene.settings.width) / scene.settings.height;
  completed.camera = scene.camera ? *scene.camera : make_camera(completed.optical_function, aspect);
  return completed;
}

}  // namespace

CompletedScene complete_scene(const Scene& scene, const PreparedMesh& mesh) {
  return complete(scene, mesh, [&](const OpticalFunction&, double aspect) { return make_camera(mesh, aspect); });
}

CompletedScene complete_scene(const Scene& scene, const PreparedGrid& grid) {
  return complete(scene, grid,
                  [&](const OpticalFunction& function, double aspect) { return make_camera(grid, function, aspect); });
}

}  // namespace tetravox
