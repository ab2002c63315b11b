#pragma once

/// Grids at a fixed rate (`RenderSettings::samples_per_voxel`): where samples lie, and what is known of the steps
/// between them.

#include "src/optics/steepness_table.h"
#include "src/scene/brick_plan.h"
#include "tetravox/grid.h"
#include "tetravox/render.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tetravox::scene {

/// Whether steps are counted on through the whole grid, in packets of rays that read values where they lie: where
/// segments are integrated exactly, on even axes, with nothing missing; values at points, of one component, 8 or 16
/// bits or float32, 4 GiB at most, stored as they are but for a factor (the range is no less than half of the largest
/// value), between which the field is linear. Elsewhere steps start anew in each brick, if only exact integration and
/// even axes without missing values allow it (`restarts_rate`), or samples are counted on from cell to cell.
bool counts_steps(const PreparedGrid& grid, const RenderSettings& settings);

/// What that lacks, as a user is told: "a grid with even axes"; empty where nothing is lacking.
std::string find_obstacle_to_counting(const PreparedGrid& grid, const RenderSettings& settings);

/// Whether steps of a fixed rate may start anew in each brick, where it hardly matters where samples lie: exactly
/// integrated ones on even axes, with nothing missing. Elsewhere samples are counted on from cell to cell.
bool restarts_rate(const PreparedGrid& grid, Integrator integrator);

/// Whether steps that are counted may be looked up by scalars rounded to the nodes of optics::SlabTable. `steepness`:
/// of the function.
bool may_look_slabs_up(const PreparedGrid& grid, const optics::SteepnessTable& steepness,
                       const RenderSettings& settings);

/// Range of all stored scalars.
ValueRange stored_range(const PreparedGrid& grid);

/// [bricks] bit `span`: whether the brick is seen, or one of those up to one further along the axes whose bits are set
/// in `span`.
std::vector<std::uint8_t> list_seen_spans(const std::array<std::uint32_t, 3>& counts, std::span<const BrickPlan> plans);

/// Groups that hold what is seen, numbered behind `brick_count` bricks (brick_groups.h).
std::vector<std::uint32_t> list_seen_groups(std::size_t brick_count, std::span<const BrickPlan> of_groups);

}  // namespace tetravox::scene
