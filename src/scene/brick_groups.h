#pragma once

/// The second level of min-max cells: groups of 4^3 bricks, so that what a function does not show, and what it cannot
/// tell from a constant, is dealt with 32^3 cells at once.

#include "src/grid/summaries.h"
#include "src/scene/filtered_field.h"
#include "tetravox/grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::scene {

inline constexpr std::uint32_t kGroupBricks = 4;  ///< along each axis

struct BrickGroups {
  std::array<std::uint32_t, 3> counts{};  ///< groups along i, j, k
  std::vector<float> min, max;            ///< of the field in the group; min > max where it is missing throughout
  std::vector<std::uint8_t> has_missing;  ///< whether a value in the group is not finite

  std::size_t count() const { return min.size(); }
};

/// Groups of the bricks of `grid`, as `field` reconstructs it. Microseconds for a thousand bricks.
BrickGroups make_brick_groups(const PreparedGrid& grid, const FilteredField& field);

/// Bricks that a group holds: from `first` to before `end` along each axis.
struct BrickSpan {
  std::array<std::uint32_t, 3> first{}, end{};
};
BrickSpan bricks_of_group(const PreparedGrid& grid, const BrickGroups& groups, std::size_t group);

/// What a frame draws is a brick, or a group as one: numbers from `BrickSummaries::count` on are those of groups.
bool is_group(const PreparedGrid& grid, std::uint32_t drawn);
/// Position among the bricks, or among the groups.
std::array<std::uint32_t, 3> position_of(const PreparedGrid& grid, std::uint32_t drawn);
/// Its cells.
grid::BrickBox box_of_drawn(const PreparedGrid& grid, std::uint32_t drawn);

}  // namespace tetravox::scene
