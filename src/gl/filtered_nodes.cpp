#include "src/gl/filtered_nodes.h"

#include "src/grid/summaries.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace tetravox::gl {
namespace {

/// Bricks that are filtered side by side before it is looked whether they fit.
constexpr std::size_t kAtOnce = 64;

std::array<std::uint32_t, 3> position_of(const PreparedGrid& grid, std::size_t brick) {
  const auto& counts = grid.bricks.counts;
  return {static_cast<std::uint32_t>(brick % counts[0]), static_cast<std::uint32_t>(brick / counts[0] % counts[1]),
          static_cast<std::uint32_t>(brick / counts[0] / counts[1])};
}

/// Filtered scalars, or densities [nodes][4], of a brick; returns the parts of a cell.
int filter_brick(const FilteredBricks& bricks, std::size_t brick, scene::KernelLattice& lattice,
                 std::vector<float>& nodes) {
  const PreparedGrid& grid = *bricks.sources->grid;
  const grid::BrickBox box = grid::box_of_brick(grid.data.shape, position_of(grid, brick));
  lattice.read(bricks.field, {box.first, box.count});
  if (!bricks.points) {
    const ValueRange range = scene::range_of(*bricks.sources, brick);
    const float steepness =
        bricks.sources->steepness->largest_steepness(static_cast<float>(range.min), static_cast<float>(range.max));
    // In the middle of a cell everything in reach counts.
    return lattice.divide_as_asked(bricks.field, steepness, grid.missing_values > 0 ? 2 : 1, nodes);
  }
  const std::vector<float> scalars = lattice.margin();
  std::vector<float> channel_nodes;
  for (std::size_t channel = 0; channel < 4; ++channel) {
    for (std::size_t i = 0; i < scalars.size(); ++i)
      lattice.margin()[i] = optics::eval_densities(*bricks.points, scalars[i])[channel];
    lattice.divide(bricks.field, scene::kDensityParts, channel_nodes);
    nodes.resize(4 * channel_nodes.size());
    for (std::size_t i = 0; i < channel_nodes.size(); ++i) nodes[4 * i + channel] = channel_nodes[i];
  }
  return scene::kDensityParts;
}

}  // namespace

void FilteredNodes::begin(const grid::GridFrame& frame, const scene::GridView& view, const FilteredBricks& bricks,
                          const Limits& limits) {
  if (is_whole_) return;
  const PreparedGrid& grid = *bricks.sources->grid;
  room_ = std::min(limits.buffer_texels, kMostTexels);
  done_ = 0;
  order_.clear();
  for (std::size_t i = 0; i < bricks.plans->size(); ++i)
    if ((*bricks.plans)[i].level != scene::BrickPlan::kTransparent) order_.push_back(static_cast<std::uint32_t>(i));
  const std::array<std::int64_t, 3> nearest = scene::nearest_brick(grid, frame, view);
  const auto distance = [&](std::uint32_t brick) {
    const auto at = position_of(grid, brick);
    std::int64_t sum = 0;
    for (int axis = 0; axis < 3; ++axis) sum += std::abs(static_cast<std::int64_t>(at[axis]) - nearest[axis]);
    return sum;
  };
  std::ranges::stable_sort(order_, {}, distance);
}

bool FilteredNodes::next(const FilteredBricks& bricks, const Progress& progress, std::vector<NodePlace>& places) {
  if (is_whole_) {
    places = kept_;
    return false;
  }
  const std::size_t texel = bricks.points ? 4 : 1, first = done_;
  places.assign(bricks.plans->size(), {});
  std::vector<float> all;
  bool is_full = false;
  while (done_ < order_.size() && !is_full) {
    const std::size_t count = std::min(kAtOnce, order_.size() - done_);
    std::vector<std::vector<float>> nodes(count);
    std::vector<int> parts(count);
    support::parallel_chunks(count, 1, [&](std::size_t begin, std::size_t end) {
      scene::KernelLattice lattice;
      for (std::size_t i = begin; i < end; ++i) parts[i] = filter_brick(bricks, order_[done_ + i], lattice, nodes[i]);
    });
    support::throw_if_cancelled(progress);
    const std::size_t from = done_;
    for (std::size_t i = 0; i < count && !is_full; ++i) {
      is_full = !all.empty() && (all.size() + nodes[i].size()) / texel > room_;
      if (is_full) break;
      places[order_[from + i]] = {static_cast<std::uint32_t>(all.size() / texel), static_cast<std::uint32_t>(parts[i])};
      all.insert(all.end(), nodes[i].begin(), nodes[i].end());
      ++done_;
    }
  }
  nodes_.upload(texel == 4 ? GL_RGBA32F : GL_R32F, all.data(), all.size() * sizeof(float));
  is_whole_ = first == 0 && done_ == order_.size();
  if (is_whole_) kept_ = places;
  return done_ < order_.size();
}

}  // namespace tetravox::gl
