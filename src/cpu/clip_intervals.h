#pragma once

/// Clipping, ray by ray: the depths between which a ray lies in what is kept. Sources of segments need know no shape.

#include "src/cpu/clip_field.h"
#include "src/cpu/kernels/effects.h"
#include "tetravox/clipping.h"
#include "tetravox/grid.h"

#include <array>
#include <span>
#include <variant>
#include <vector>

namespace tetravox::cpu {

/// A ray of the camera frame: (x_offset + x_slope z, y_offset + y_slope z, z).
struct ClipRay {
  double x_offset = 0.0, x_slope = 0.0, y_offset = 0.0, y_slope = 0.0;
  double z_begin = 0.0, z_end = 0.0;
};

/// The clipping of a frame, in its camera's frame. Views the volumes; safe to use from many threads.
struct ClipScene {
  /// Where constant + normal * position >= 0.
  struct Plane {
    std::array<double, 3> normal{};
    double constant = 0.0;
  };
  /// Three pairs of planes: normals[i] * position in bounds[i].
  struct Box {
    std::array<std::array<double, 3>, 3> normals{};
    std::array<ValueRange, 3> bounds{};
  };
  struct Sphere {
    std::array<double, 3> center{};
    double radius = 0.0;
  };
  struct Volume {
    ClipField field;
    std::array<double, 12> grid_from_camera{};  ///< rows of a 3 x 4 matrix
  };
  struct Shape {
    std::variant<Plane, Box, Sphere, Volume> shape;
    bool keeps_inside = true;
  };
  std::vector<Shape> shapes;
  bool use_union = false;
};

/// `volumes`: one a shape, null where it is no volume; they must outlive what comes back. Everything is computed
/// relative to the camera frame's origin, so that data far from the world's lose nothing.
ClipScene make_clip_scene(const Clipping& clipping, std::span<const PreparedGrid* const> volumes,
                          const std::array<double, 12>& world_from_camera);

/// What a thread needs while it clips rays of one scene: it keeps what it read of volumes last.
struct ClipScratch {
  std::vector<ClipField::Cache> caches;  ///< [shapes]
  DepthRanges kept, shape, other;
};

/// Appends the parts of a ray that are kept: ascending, apart, not empty and finite; all of the ray where there are no
/// shapes. A ray that only touches a shape is not cut by it.
void find_intervals(const ClipScene& scene, const ClipRay& ray, ClipScratch& scratch,
                    std::vector<ClipInterval>& intervals);

}  // namespace tetravox::cpu
