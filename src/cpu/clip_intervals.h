#pragma once

/// Clipping, ray by ray: the depths between which a ray lies in what is kept. Sources of segments need know no shape.

#include "src/cpu/clip_field.h"
#include "src/cpu/kernels/effects.h"
#include "tetravox/clipping.h"
#include "tetravox/grid.h"

#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tetravox::cpu {

/// The clipping of a frame. Safe to use from many threads.
struct ClipScene {
  struct Shape {
    ClipShape shape;
    std::shared_ptr<const ClipField> field;  ///< of a volume
  };
  std::vector<Shape> shapes;
  bool use_union = false;
  std::array<double, 12> world_from_camera{};  ///< rows of a 3 x 4 matrix
};

/// `volumes`: one a shape, null where it is no volume; they must outlive what comes back.
ClipScene make_clip_scene(const Clipping& clipping, std::span<const PreparedGrid* const> volumes,
                          const std::array<double, 12>& world_from_camera);

/// A ray of the camera frame: (x_offset + x_slope z, y_offset + y_slope z, z).
struct ClipRay {
  double x_offset = 0.0, x_slope = 0.0, y_offset = 0.0, y_slope = 0.0;
  double z_begin = 0.0, z_end = 0.0;
};

/// Appends the parts of a ray that are kept, ascending, apart and not empty.
void find_intervals(const ClipScene& scene, const ClipRay& ray, std::vector<ClipInterval>& intervals);

}  // namespace tetravox::cpu
