#pragma once

/// Where along a ray the field of a grid, linear between its values, is at least a value.

#include "src/grid/frame.h"
#include "src/grid/values.h"
#include "tetravox/grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::cpu {

/// Depths [begin, end), begin < end.
struct DepthRange {
  double begin = 0.0, end = 0.0;
};

/// Sorted; none touches the next.
using DepthRanges = std::vector<DepthRange>;

/// Appends a range that begins where the last one ends, or later. One that touches the last becomes part of it; one
/// without length is left out.
inline void append_range(DepthRanges& ranges, double begin, double end) {
  if (!(begin < end)) return;
  if (!ranges.empty() && ranges.back().end >= begin)
    ranges.back().end = end;
  else
    ranges.push_back({begin, end});
}

/// A line in any frame: origin + z * direction.
struct DepthLine {
  std::array<double, 3> origin{}, direction{};
};

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
  using Index = std::array<std::int64_t, 3>;

  bool cut_with_bounds(const DepthLine& line, double& z_begin, double& z_end) const;
  template <class Visit>
  void walk(const DepthLine& line, const Lattice& lattice, double z_begin, double z_end, const Visit& visit) const;
  const float* values_of(const Index& brick, std::uint32_t index, Cache& cache) const;
  void find_in_brick(const DepthLine& line, const Index& brick, const float* values, double z_begin, double z_end,
                     DepthRanges& ranges) const;
  void find_in_cell(const DepthLine& line, const Index& cell, const std::array<float, 8>& corners, double z_begin,
                    double z_end, DepthRanges& ranges) const;

  const PreparedGrid* grid_;
  grid::GridFrame frame_;
  grid::BlockReader reader_;
  bool is_point_;
  float threshold_;  ///< stored scalar
};

}  // namespace tetravox::cpu
