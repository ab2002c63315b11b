#pragma once

/// A grid as the camera sees it: which bricks, in which order, in which tiles.

#include "src/cpu/kernels/kernels.h"
#include "src/grid/frame.h"
#include "src/scene/grid_view.h"
#include "tetravox/grid.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::cpu {

/// A brick with the pixels of a tile that may see it.
struct BinnedBrick {
  std::uint32_t brick = 0;  ///< or a group, see scene/brick_groups.h
  TileBounds bounds;        ///< counted from the tile's corner
};

/// The bricks of each tile, front to back.
struct BrickBins {
  int columns = 0, rows = 0;  ///< of tiles
  std::vector<std::size_t> starts;
  std::vector<BinnedBrick> bricks;

  std::size_t tile_count() const { return static_cast<std::size_t>(columns) * rows; }
  std::span<const BinnedBrick> bricks_of(std::size_t tile) const {
    return {bricks.data() + starts[tile], bricks.data() + starts[tile + 1]};
  }
};

/// Orders `bricks` (numbers as in scene/brick_groups.h) front to back and sorts them into tiles. Along any ray from the
/// eye the number of groups of bricks between a group and the eye's, counted along the axes and summed, ascends, and so
/// does that of bricks inside a group: these numbers are the order.
BrickBins bin_bricks(const PreparedGrid& grid, const grid::GridFrame& frame, const std::vector<std::uint32_t>& bricks,
                     const scene::GridView& view);

}  // namespace tetravox::cpu
