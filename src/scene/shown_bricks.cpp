#include "src/scene/shown_bricks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tetravox::scene {
namespace {

/// A lattice point in world coordinates.
Vector3 place_of(const GridShape& shape, const std::array<std::uint32_t, 3>& index) {
  Vector3 along{}, place = shape.origin;
  for (std::size_t a = 0; a < 3; ++a)
    along[a] = shape.coordinates[a].empty() ? index[a] * shape.spacing[a] : shape.coordinates[a][index[a]];
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t a = 0; a < 3; ++a) place[row] += shape.direction[3 * row + a] * along[a];
  return place;
}

void visit_corners(const GridShape& shape, const std::array<std::uint32_t, 3>& brick,
                   const std::function<void(const Vector3&)>& visit) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::array<std::uint32_t, 3> index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = std::min((brick[a] + ((corner >> a) & 1u)) * kBrickCells, shape.dimensions[a] - 1);
    visit(place_of(shape, index));
  }
}

}  // namespace

void visit_hull(const PreparedGrid& grid, const WantsBrick& wants, const std::function<void(const Vector3&)>& visit) {
  const BrickSummaries& bricks = grid.bricks;
  const auto [width, height, depth] = bricks.counts;
  for (std::uint32_t k = 0; k < depth; ++k)
    for (std::uint32_t j = 0; j < height; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k) * height + j) * width;
      const auto is_wanted = [&](std::uint32_t i) {
        const float min = bricks.min[row + i], max = bricks.max[row + i];
        return min <= max && wants(min, max);
      };
      std::uint32_t first = 0, last = width;
      while (first < width && !is_wanted(first)) ++first;
      if (first == width) continue;
      while (!is_wanted(last - 1)) --last;
      visit_corners(grid.data.shape, {first, j, k}, visit);
      if (last - 1 > first) visit_corners(grid.data.shape, {last - 1, j, k}, visit);
    }
}

std::optional<std::array<ValueRange, 3>> bounds_of_bricks(const PreparedGrid& grid, const WantsBrick& wants) {
  std::optional<std::array<ValueRange, 3>> bounds;
  visit_hull(grid, wants, [&](const Vector3& point) {
    if (!bounds) {
      bounds.emplace();
      for (std::size_t a = 0; a < 3; ++a) (*bounds)[a] = {point[a], point[a]};
    }
    for (std::size_t a = 0; a < 3; ++a)
      (*bounds)[a] = {std::min((*bounds)[a].min, point[a]), std::max((*bounds)[a].max, point[a])};
  });
  return bounds;
}

}  // namespace tetravox::scene
