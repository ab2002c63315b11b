#pragma once

/// Where a grid has what a function shows, brick by brick.

#include "src/scene/camera_fit.h"
#include "tetravox/grid.h"

#include <array>
#include <functional>
#include <optional>

namespace tetravox::scene {

/// Whether a brick whose stored scalars lie in [min, max] is wanted.
using WantsBrick = std::function<bool(float min, float max)>;

/// Calls `visit` with the eight corners (world) of boxes whose convex hull holds what is wanted: the wanted values of
/// bricks and the cells around them, in all bricks of small grids, in the first and the last of each row of larger
/// ones. There, bricks with a few scattered values (noise) do not count.
void visit_hull(const PreparedGrid& grid, const WantsBrick& wants, const std::function<void(const Vector3&)>& visit);

/// Bounds of the bricks that are wanted, world; empty where there is none.
std::optional<std::array<ValueRange, 3>> bounds_of_bricks(const PreparedGrid& grid, const WantsBrick& wants);

}  // namespace tetravox::scene
