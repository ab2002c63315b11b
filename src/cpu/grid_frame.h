#pragma once

/// A grid as the camera sees it: which bricks, in which order, in which tiles.

#include "src/cpu/frame.h"
#include "src/cpu/kernels/kernels.h"
#include "src/grid/frame.h"
#include "tetravox/grid.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::cpu {

/// Local lengths of a grid: world = origin + local * world_per_local, so that |local| <= 1.
struct LocalFrame {
  Vector3 origin{};  ///< the middle of the bounds
  double world_per_local = 1.0;
};
LocalFrame find_local_frame(const PreparedGrid& grid);

/// The camera's frame of a grid, and the way from it to grid coordinates.
struct GridView {
  CameraFrame camera;
  std::array<double, 12> grid_from_camera{};  ///< rows of a 3 x 4 matrix
  std::array<double, 12> camera_from_grid{};
  grid::Point eye{};  ///< grid coordinates; of an orthographic camera: the direction it looks in
  Vector3 origin{};   ///< world position of the local origin
  double world_per_local = 1.0;
};

GridView make_grid_view(const PreparedGrid& grid, const grid::GridFrame& frame, const Camera& camera, int width,
                        int height);

/// World length of a voxel: of the cube with its volume.
double mean_spacing(const grid::GridFrame& frame);

/// World length of the longest diagonal of a cell.
double longest_cell_diagonal(const grid::GridFrame& frame);

/// A brick with the pixels of a tile that may see it.
struct BinnedBrick {
  std::uint32_t brick = 0;
  TileBounds bounds;  ///< counted from the tile's corner
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

/// Orders `bricks` (indices) front to back and sorts them into tiles. Along any ray from the eye the number of bricks
/// between a brick and the eye's, counted along the axes and summed, ascends: that number is the order.
BrickBins bin_bricks(const PreparedGrid& grid, const grid::GridFrame& frame, const std::vector<std::uint32_t>& bricks,
                     const GridView& view);

}  // namespace tetravox::cpu
