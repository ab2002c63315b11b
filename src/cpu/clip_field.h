#pragma once

/// Where along a ray the field of a grid, linear between its values, is at least a value.

#include "src/cpu/lattice_walk.h"
#include "src/grid/frame.h"
#include "src/grid/values.h"
#include "tetravox/grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::cpu {

/// A grid as something to clip with. Views the grid; safe to read from many threads.
class ClipField {
 public:
  ClipField(const PreparedGrid& grid, double value);

  /// Bricks that a thread has read. Neighbours do not push each other out.
  struct Cache {
    struct Brick {
      std::uint32_t index = 0xFFFFFFFFu;
      std::array<float, (kBrickCells + 1) * (kBrickCells + 1) * (kBrickCells + 1)> values{};
    };
    std::vector<Brick> bricks;  ///< about 190 kB once a ray has met the field
  };

  /// Appends the depths in (z_begin, z_end) where the field is at least the value. `line`: in grid coordinates. Outside
  /// the grid, and in cells with a corner (or, cell data, a value) that is missing, it is not.
  void find_inside(const DepthLine& line, double z_begin, double z_end, Cache& cache, DepthRanges& ranges) const;

  const grid::GridFrame& frame() const { return frame_; }

 private:
  struct Lattice;
  const float* values_of(const LatticeIndex& brick, std::uint32_t index, Cache& cache) const;
  void find_in_brick(const DepthLine& line, const LatticeIndex& brick, const float* values, double z_begin,
                     double z_end, DepthRanges& ranges) const;
  void find_in_cell(const DepthLine& line, const LatticeIndex& cell, const std::array<float, 8>& corners,
                    double z_begin, double z_end, DepthRanges& ranges) const;

  const PreparedGrid* grid_;
  grid::GridFrame frame_;
  grid::BlockReader reader_;
  bool is_point_;
  float threshold_;  ///< stored scalar
};

}  // namespace tetravox::cpu
