#include "src/scene/shown_bricks.h"

#include "src/grid/values.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::scene {
namespace {

constexpr std::size_t kFewBricks = 4096;  // of a small grid: 128^3 cells
constexpr double kLeastShare = 0.03;      // of a brick's values, in larger grids: fewer are noise

/// A lattice point in world coordinates.
Vector3 place_of(const GridShape& shape, const std::array<std::uint32_t, 3>& index) {
  Vector3 along{}, place = shape.origin;
  for (std::size_t a = 0; a < 3; ++a)
    along[a] = shape.coordinates[a].empty() ? index[a] * shape.spacing[a] : shape.coordinates[a][index[a]];
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t a = 0; a < 3; ++a) place[row] += shape.direction[3 * row + a] * along[a];
  return place;
}

/// Lattice points, first and last.
struct IndexBox {
  std::array<std::uint32_t, 3> first{}, last{};
};

IndexBox box_of(const GridShape& shape, const std::array<std::uint32_t, 3>& brick) {
  IndexBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.first[a] = brick[a] * kBrickCells;
    box.last[a] = std::min(box.first[a] + kBrickCells, shape.dimensions[a] - 1);
  }
  return box;
}

/// The box around the wanted values and the cells next to them; all of it where no value is wanted by itself. Empty
/// where fewer values than `least` are wanted.
std::optional<IndexBox> shrink(const PreparedGrid& grid, const grid::BlockReader& reader, const WantsBrick& wants,
                               const IndexBox& box, double least) {
  grid::Block block;
  for (std::size_t a = 0; a < 3; ++a) {
    block.first[a] = box.first[a];
    block.count[a] = static_cast<std::int64_t>(box.last[a]) - box.first[a] + 1;
  }
  std::vector<float> values(static_cast<std::size_t>(block.size()));
  reader.read(block, values.data());
  IndexBox found{box.last, box.first};
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i]) || !wants(values[i], values[i])) continue;
    ++count;
    auto rest = static_cast<std::int64_t>(i);
    for (std::size_t a = 0; a < 3; rest /= block.count[a++]) {
      const auto index = static_cast<std::uint32_t>(block.first[a] + rest % block.count[a]);
      found.first[a] = std::min(found.first[a], index > 0 ? index - 1 : 0);
      found.last[a] = std::max(found.last[a], std::min(index + 1, grid.data.shape.dimensions[a] - 1));
    }
  }
  if (static_cast<double>(count) < least * static_cast<double>(values.size())) return std::nullopt;
  return count > 0 ? found : box;
}

void visit_corners(const GridShape& shape, const IndexBox& box, const std::function<void(const Vector3&)>& visit) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::array<std::uint32_t, 3> index{};
    for (std::size_t a = 0; a < 3; ++a) index[a] = (corner >> a) & 1u ? box.last[a] : box.first[a];
    visit(place_of(shape, index));
  }
}

}  // namespace

void visit_hull(const PreparedGrid& grid, const WantsBrick& wants, const std::function<void(const Vector3&)>& visit) {
  const BrickSummaries& bricks = grid.bricks;
  const grid::BlockReader reader(grid.data, {grid.scalar_offset, grid.scalar_scale});
  const bool is_small = bricks.count() <= kFewBricks;
  const double least = is_small ? 0.0 : kLeastShare;
  const auto [width, height, depth] = bricks.counts;
  for (std::uint32_t k = 0; k < depth; ++k)
    for (std::uint32_t j = 0; j < height; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k) * height + j) * width;
      std::vector<std::uint32_t> wanted;
      for (std::uint32_t i = 0; i < width; ++i)
        if (bricks.min[row + i] <= bricks.max[row + i] && wants(bricks.min[row + i], bricks.max[row + i]))
          wanted.push_back(i);
      // Noise around the objects does not count; the outermost bricks that hold more stand for those between.
      const auto visit_first = [&](auto begin, auto end) {
        for (; begin != end; ++begin) {
          const auto box = shrink(grid, reader, wants, box_of(grid.data.shape, {*begin, j, k}), least);
          if (box) visit_corners(grid.data.shape, *box, visit);
          if (box && !is_small) break;
        }
      };
      visit_first(wanted.begin(), wanted.end());
      if (!is_small) visit_first(wanted.rbegin(), wanted.rend());
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
