#include "src/scene/camera_fit.h"
#include "src/scene/histogram_limits.h"
#include "src/scene/shown_bricks.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cstddef>
#include <limits>
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

/// Tells which values a function shows: the intervals in which it is dense enough, ascending and apart.
class ShownValues {
 public:
  ShownValues(const OpticalFunction& function, double least_extinction) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto is_shown = [&](const OpticalPoint& point) { return point.extinction > least_extinction; };
    const auto& points = function.points;
    if (is_shown(points.front())) add(-kInfinity, points.front().value);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const OpticalPoint &a = points[i], &b = points[i + 1];
      if (!is_shown(a) && !is_shown(b)) continue;
      const double rise = b.extinction - a.extinction;
      const double t = rise != 0.0 ? (least_extinction - a.extinction) / rise : 0.0;
      const double crossing = a.value + std::clamp(t, 0.0, 1.0) * (b.value - a.value);
      add(is_shown(a) ? a.value : crossing, is_shown(b) ? b.value : crossing);
    }
    if (is_shown(points.back())) add(points.back().value, kInfinity);
  }
  /// Whether a value in [min, max] is shown.
  bool any(double min, double max) const {
    const auto first = std::lower_bound(intervals_.begin(), intervals_.end(), min,
                                        [](const ValueRange& interval, double value) { return interval.max < value; });
    return first != intervals_.end() && first->min <= max;
  }

 private:
  void add(double begin, double end) {
    if (!intervals_.empty() && begin <= intervals_.back().max)
      intervals_.back().max = std::max(intervals_.back().max, end);
    else
      intervals_.push_back({begin, end});
  }

  std::vector<ValueRange> intervals_;
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
