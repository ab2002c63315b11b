#include "src/cpu/clip_field.h"

#include "src/cpu/cell_cubic.h"
#include "src/grid/summaries.h"

#include <algorithm>
#include <cmath>

namespace tetravox::cpu {
namespace {

constexpr std::size_t kCachedAlong = 4;  // bricks along an axis

/// Where the cubic is 0 between two places of different sign, monotone between them: Newton's method, kept in a bracket
/// that is halved where a step leaves it.
double find_root(const Cubic& c, double low, double high) {
  const bool rises = eval_cubic(c, low) < 0.0;
  double t = 0.5 * (low + high);
  for (int step = 0; step < 60; ++step) {
    const double f = eval_cubic(c, t);
    if (f == 0.0) return t;
    ((f < 0.0) == rises ? low : high) = t;
    double next = t - f / eval_cubic_slope(c, t);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - t) <= 1e-13) return next;
    t = next;
  }
  return t;
}

}  // namespace

/// Boxes of `stride` cells a side (fewer at the upper ends) from cell `first` on, `counts` along each axis.
struct ClipField::Lattice {
  const ClipField* field = nullptr;
  LatticeIndex first{}, counts{};
  std::int64_t stride = 1;

  std::int64_t count(std::size_t axis) const { return counts[axis]; }
  double plane(std::size_t axis, std::int64_t index) const {
    const std::int64_t last = field->grid_->data.shape.dimensions[axis] - 1;
    return static_cast<double>(
        field->frame_.plane(static_cast<int>(axis), std::min(last, first[axis] + index * stride)));
  }
  std::int64_t find(std::size_t axis, double coordinate) const {
    if (field->frame_.planes[axis].empty())
      return static_cast<std::int64_t>(
          std::floor((coordinate - static_cast<double>(first[axis])) / static_cast<double>(stride)));
    std::int64_t index = 0;
    while (index + 1 < counts[axis] && plane(axis, index + 1) <= coordinate) ++index;
    return index;
  }
};

ClipField::ClipField(const PreparedGrid& grid, double value)
    : grid_(&grid),
      frame_(grid::make_grid_frame(grid.data.shape)),
      reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}),
      is_point_(grid.data.association == Association::kPoint),
      // Rounded as values are, so that those equal to it stay equal.
      threshold_(static_cast<float>((value - grid.scalar_offset) / grid.scalar_scale)) {}

const float* ClipField::values_of(const LatticeIndex& brick, std::uint32_t index, Cache& cache) const {
  if (cache.bricks.empty()) cache.bricks.resize(kCachedAlong * kCachedAlong * kCachedAlong);
  std::size_t slot = 0;
  for (int axis = 2; axis >= 0; --axis)
    slot = slot * kCachedAlong + static_cast<std::size_t>(brick[axis]) % kCachedAlong;
  Cache::Brick& cached = cache.bricks[slot];
  if (cached.index != index) {
    const grid::BrickBox box = grid::box_of_brick(
        grid_->data.shape, {static_cast<std::uint32_t>(brick[0]), static_cast<std::uint32_t>(brick[1]),
                            static_cast<std::uint32_t>(brick[2])});
    grid::Block block{box.first, box.count};
    if (is_point_)
      for (std::int64_t& nodes : block.count) ++nodes;
    reader_.read(block, cached.values.data());
    cached.index = index;
  }
  return cached.values.data();
}

void ClipField::find_inside(const DepthLine& line, double z_begin, double z_end, Cache& cache,
                            DepthRanges& ranges) const {
  std::array<double, 3> upper{};
  for (int axis = 0; axis < 3; ++axis) upper[axis] = frame_.plane(axis, grid_->data.shape.dimensions[axis] - 1);
  if (!cut_with_box(line, {}, upper, z_begin, z_end)) return;
  const BrickSummaries& bricks = grid_->bricks;
  Lattice lattice{this, {}, {}, kBrickCells};
  for (int axis = 0; axis < 3; ++axis) lattice.counts[axis] = bricks.counts[axis];
  walk_lattice(line, lattice, z_begin, z_end, [&](const LatticeIndex& at, double z_near, double z_far) {
    const auto index = static_cast<std::uint32_t>((at[2] * lattice.counts[1] + at[1]) * lattice.counts[0] + at[0]);
    if (bricks.max[index] < threshold_) return true;
    if (bricks.min[index] >= threshold_ && !bricks.has_missing[index])
      append_range(ranges, z_near, z_far);
    else
      find_in_brick(line, at, values_of(at, index, cache), z_near, z_far, ranges);
    return true;
  });
}

void ClipField::find_in_brick(const DepthLine& line, const LatticeIndex& brick, const float* values, double z_begin,
                              double z_end, DepthRanges& ranges) const {
  Lattice lattice{this, {}, {}, 1};
  LatticeIndex nodes{};
  for (int axis = 0; axis < 3; ++axis) {
    lattice.first[axis] = brick[axis] * kBrickCells;
    lattice.counts[axis] =
        std::min<std::int64_t>(kBrickCells, grid_->data.shape.dimensions[axis] - 1 - lattice.first[axis]);
    nodes[axis] = lattice.counts[axis] + (is_point_ ? 1 : 0);
  }
  walk_lattice(line, lattice, z_begin, z_end, [&](const LatticeIndex& at, double z_near, double z_far) {
    const float* first = values + (at[2] * nodes[1] + at[1]) * nodes[0] + at[0];
    if (!is_point_) {
      if (*first >= threshold_) append_range(ranges, z_near, z_far);
      return true;
    }
    std::array<float, 8> corners;
    int inside = 0;
    bool is_missing = false;
    for (std::int64_t corner = 0; corner < 8; ++corner) {
      const float value = first[(corner & 1) + (corner >> 1 & 1) * nodes[0] + (corner >> 2) * nodes[0] * nodes[1]];
      corners[static_cast<std::size_t>(corner)] = value;
      inside += value >= threshold_;
      is_missing |= value != value;
    }
    if (is_missing || inside == 0) return true;
    if (inside == 8)
      append_range(ranges, z_near, z_far);
    else
      find_in_cell(line, {lattice.first[0] + at[0], lattice.first[1] + at[1], lattice.first[2] + at[2]}, corners,
                   z_near, z_far, ranges);
    return true;
  });
}

void ClipField::find_in_cell(const DepthLine& line, const LatticeIndex& cell, const std::array<float, 8>& corners,
                             double z_begin, double z_end, DepthRanges& ranges) const {
  std::array<double, 8> above;
  for (int i = 0; i < 8; ++i) above[i] = static_cast<double>(corners[i]) - threshold_;
  std::array<double, 3> at{}, step{};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = frame_.plane(axis, cell[axis]), size = frame_.plane(axis, cell[axis] + 1) - low;
    const auto place = [&](double z) {
      return std::clamp((line.origin[axis] + z * line.direction[axis] - low) / size, 0.0, 1.0);
    };
    at[axis] = place(z_begin);
    step[axis] = place(z_end) - at[axis];
  }
  const Cubic cubic = make_cubic(above, at, step);
  std::array<double, 4> ends;
  const int count = split_at_extrema(cubic, ends);
  // The ends of the cell keep their depths exactly, so that ranges of neighbours touch.
  const auto depth = [&](double t) { return t >= 1.0 ? z_end : std::min(z_end, z_begin + t * (z_end - z_begin)); };
  for (int i = 0; i + 1 < count; ++i) {
    const double front = ends[i], back = ends[i + 1];
    const bool begins_inside = eval_cubic(cubic, front) >= 0.0, ends_inside = eval_cubic(cubic, back) >= 0.0;
    if (!begins_inside && !ends_inside) continue;
    const double root = begins_inside == ends_inside ? front : find_root(cubic, front, back);
    append_range(ranges, depth(begins_inside ? front : root), depth(ends_inside ? back : root));
  }
}

}  // namespace tetravox::cpu
