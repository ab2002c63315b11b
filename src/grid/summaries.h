#pragma once

/// What a renderer knows of a brick before it looks into it.

#include "src/grid/values.h"
#include "tetravox/grid.h"
#include "tetravox/progress.h"

#include <array>
#include <cstdint>

namespace tetravox::grid {

/// The cells of a brick: from `first`, `count` along each axis (kBrickCells, or fewer at the upper ends).
struct BrickBox {
  std::array<std::int64_t, 3> first{};
  std::array<std::int64_t, 3> count{};
};
BrickBox box_of_brick(const GridShape& shape, const std::array<std::uint32_t, 3>& brick);

/// Summaries of all bricks of a grid. Deterministic.
/// @throws Error (kCancelled).
BrickSummaries summarize_bricks(const GridData& grid, const ScalarFrame& frame, const Progress& progress);

}  // namespace tetravox::grid
