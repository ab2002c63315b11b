#include "src/scene/brick_groups.h"

#include <algorithm>
#include <limits>

namespace tetravox::scene {
namespace {

constexpr std::uint32_t kGroupCells = kGroupBricks * kBrickCells;

std::uint32_t groups_along(std::uint32_t bricks) { return (bricks + kGroupBricks - 1) / kGroupBricks; }

std::array<std::uint32_t, 3> unravel(std::size_t index, std::uint32_t width, std::uint32_t height) {
  return {static_cast<std::uint32_t>(index % width), static_cast<std::uint32_t>(index / width % height),
          static_cast<std::uint32_t>(index / width / height)};
}

}  // namespace

BrickGroups make_brick_groups(const PreparedGrid& grid, const FilteredField& field) {
  const BrickSummaries& bricks = grid.bricks;
  BrickGroups groups;
  for (std::size_t axis = 0; axis < 3; ++axis) groups.counts[axis] = groups_along(bricks.counts[axis]);
  const auto [width, height, depth] = groups.counts;
  const std::size_t count = static_cast<std::size_t>(width) * height * depth;
  groups.min.assign(count, std::numeric_limits<float>::infinity());
  groups.max.assign(count, -std::numeric_limits<float>::infinity());
  groups.has_missing.assign(count, 0);
  const std::vector<float>& min = field.kernel ? field.min : bricks.min;
  const std::vector<float>& max = field.kernel ? field.max : bricks.max;
  std::size_t brick = 0;
  for (std::uint32_t k = 0; k < bricks.counts[2]; ++k)
    for (std::uint32_t j = 0; j < bricks.counts[1]; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k / kGroupBricks) * height + j / kGroupBricks) * width;
      for (std::uint32_t i = 0; i < bricks.counts[0]; ++i, ++brick) {
        const std::size_t group = row + i / kGroupBricks;
        groups.min[group] = std::min(groups.min[group], min[brick]);
        groups.max[group] = std::max(groups.max[group], max[brick]);
        groups.has_missing[group] |= bricks.has_missing[brick];
      }
    }
  return groups;
}

BrickSpan bricks_of_group(const PreparedGrid& grid, const BrickGroups& groups, std::size_t group) {
  BrickSpan span;
  const std::array<std::uint32_t, 3> at = unravel(group, groups.counts[0], groups.counts[1]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    span.first[axis] = at[axis] * kGroupBricks;
    span.end[axis] = std::min(span.first[axis] + kGroupBricks, grid.bricks.counts[axis]);
  }
  return span;
}

bool is_group(const PreparedGrid& grid, std::uint32_t drawn) { return drawn >= grid.bricks.count(); }

std::array<std::uint32_t, 3> position_of(const PreparedGrid& grid, std::uint32_t drawn) {
  const auto& counts = grid.bricks.counts;
  if (!is_group(grid, drawn)) return unravel(drawn, counts[0], counts[1]);
  return unravel(drawn - grid.bricks.count(), groups_along(counts[0]), groups_along(counts[1]));
}

grid::BrickBox box_of_drawn(const PreparedGrid& grid, std::uint32_t drawn) {
  const std::array<std::uint32_t, 3> at = position_of(grid, drawn);
  if (!is_group(grid, drawn)) return grid::box_of_brick(grid.data.shape, at);
  grid::BrickBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.first[axis] = static_cast<std::int64_t>(at[axis]) * kGroupCells;
    box.count[axis] = std::min<std::int64_t>(kGroupCells, grid.data.shape.dimensions[axis] - 1 - box.first[axis]);
  }
  return box;
}

}  // namespace tetravox::scene
