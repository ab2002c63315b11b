#pragma once

/// Where along a ray the field of a grid, linear between its values, is at least some value.

#include "src/grid/frame.h"
#include "src/grid/values.h"
#include "tetravox/grid.h"

#include <array>
#include <utility>
#include <vector>

namespace tetravox::cpu {

/// From depth to depth.
using DepthRange = std::pair<double, double>;

/// A line in grid coordinates: origin + z * direction.
struct GridLine {
  std::array<double, 3> origin{}, direction{};
};

class ClipField {
 public:
  /// Views the grid. Point data; of cell data the values count as constant in their cells.
  ClipField(const PreparedGrid& grid, double value);

  const grid::GridFrame& frame() const { return frame_; }

  /// Appends the parts of a line that lie inside, ascending. Outside the grid, and in cells with a missing corner, is
  /// outside. Bricks that are inside or outside throughout are passed at once; in a cell the field along a line is a
  /// cubic, whose crossings are found between its extrema.
  void find_inside(const GridLine& line, std::vector<DepthRange>& inside) const;

 private:
  class Walk;

  const PreparedGrid& grid_;
  grid::GridFrame frame_;
  grid::BlockReader reader_;
  float value_;  ///< stored scalar
};

}  // namespace tetravox::cpu
