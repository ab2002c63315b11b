#pragma once

/// The parts of a tile's rays that the clipping keeps.

#include "src/cpu/clip_intervals.h"
#include "src/cpu/kernels/kernels.h"
#include "src/scene/camera_frame.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace tetravox::cpu {

/// Rays go through their intervals one after the other: `MarchRays::z_near` and `z_far` hold the one at hand.
class TileIntervals {
 public:
  /// Finds them, and puts each ray at the first. `column` and `row`: the pixel in the tile's corner.
  void find(const ClipScene& clip, const scene::RayGrid& grid, int column, int row, MarchRays& rays);

  /// What has been drawn of the `count` rays that met a brick is not drawn again.
  static void note_drawn(MarchRays& rays, int count);

  /// Moves the rays that have left their interval in the brick at hand to the next one; whether there are any.
  bool advance_ended(MarchRays& rays);

  /// Moves all rays to their next interval; those that have none, or are settled, end. Whether there are any left.
  bool advance_all(MarchRays& rays);

 private:
  static constexpr float kNothing = -std::numeric_limits<float>::max();  // a ray that ends before it begins

  bool advance(std::size_t ray, MarchRays& rays);

  ClipScratch scratch_;
  std::vector<ClipInterval> intervals_;
  std::vector<std::size_t> next_, end_;  // of each ray
};

}  // namespace tetravox::cpu
