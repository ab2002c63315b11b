#include "src/cpu/clip_field.h"

#include "src/grid/summaries.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::cpu {
namespace {

constexpr std::size_t kCachedAlong = 4;  // bricks along an axis

/// c[0] + c[1] t + c[2] t^2 + c[3] t^3.
using Cubic = std::array<double, 4>;

double eval_cubic(const Cubic& c, double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }

double eval_slope(const Cubic& c, double t) { return c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]); }

/// The field of a cell along a line that runs from `at` to `at` + `step` in it, both in units of the cell, for t in
/// [0, 1]. Corners: x first.
Cubic make_cubic(const std::array<double, 8>& v, const std::array<double, 3>& at, const std::array<double, 3>& step) {
  const double x = v[1] - v[0], y = v[2] - v[0], z = v[4] - v[0];
  const double xy = v[3] - v[2] - x, xz = v[5] - v[4] - x, yz = v[6] - v[4] - y;
  const double xyz = v[7] - v[6] - v[5] + v[4] - xy;
  const auto [a, b, c] = at;
  const auto [p, q, r] = step;
  return {v[0] + x * a + y * b + z * c + xy * a * b + xz * a * c + yz * b * c + xyz * a * b * c,
          x * p + y * q + z * r + xy * (a * q + b * p) + xz * (a * r + c * p) + yz * (b * r + c * q) +
              xyz * (a * b * r + a * c * q + b * c * p),
          xy * p * q + xz * p * r + yz * q * r + xyz * (a * q * r + b * p * r + c * p * q), xyz * p * q * r};
}

/// Ends of the pieces of [0, 1] in which the cubic is monotone: 0, its extrema, 1. Returns how many.
int split_at_extrema(const Cubic& c, std::array<double, 4>& ends) {
  ends[0] = 0.0;
  int count = 1;
  const double a = 3.0 * c[3], half_b = c[2], d = half_b * half_b - a * c[1];
  if (d > 0.0) {
    // The sum without cancellation gives one root, the product of the roots the other.
    const double sum = -(half_b + std::copysign(std::sqrt(d), half_b));
    double first = a != 0.0 ? sum / a : -1.0, second = sum != 0.0 ? c[1] / sum : -1.0;
    if (first > second) std::swap(first, second);
    for (const double t : {first, second})
      if (t > ends[count - 1] && t < 1.0) ends[count++] = t;
  }
  ends[count++] = 1.0;
  return count;
}

/// Where the cubic is 0 between two places of different sign, monotone between them: Newton's method, kept in a bracket
/// that is halved where a step leaves it.
double find_root(const Cubic& c, double low, double high) {
  const bool rises = eval_cubic(c, low) < 0.0;
  double t = 0.5 * (low + high);
  for (int step = 0; step < 60; ++step) {
    const double f = eval_cubic(c, t);
    if (f == 0.0) return t;
    ((f < 0.0) == rises ? low : high) = t;
    double next = t - f / eval_slope(c, t);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - t) <= 1e-13) return next;
    t = next;
  }
  return t;
}

}  // namespace

/// Boxes of `stride` cells a side (fewer at the upper ends) from cell `first` on, `count` along each axis.
struct ClipField::Lattice {
  Index first{}, count{};
  std::int64_t stride = 1;
};

ClipField::ClipField(const PreparedGrid& grid, double value)
    : grid_(&grid),
      frame_(grid::make_grid_frame(grid.data.shape)),
      reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}),
      is_point_(grid.data.association == Association::kPoint),
      // Rounded as values are, so that those equal to it stay equal.
      threshold_(static_cast<float>((value - grid.scalar_offset) / grid.scalar_scale)) {}

bool ClipField::cut_with_bounds(const DepthLine& line, double& z_begin, double& z_end) const {
  for (int axis = 0; axis < 3; ++axis) {
    const double last = frame_.plane(axis, grid_->data.shape.dimensions[axis] - 1);
    const double origin = line.origin[axis], direction = line.direction[axis];
    if (direction == 0.0) {
      if (!(origin >= 0.0 && origin <= last)) return false;
      continue;
    }
    const double low = -origin / direction, high = (last - origin) / direction;
    z_begin = std::max(z_begin, std::min(low, high));
    z_end = std::min(z_end, std::max(low, high));
  }
  return z_begin < z_end;
}

/// Calls `visit(index in the lattice, z_begin, z_end)` for the boxes that the line meets, in order (Amanatides and Woo
/// 1987). The line lies in the lattice for these depths, but for rounding.
template <class Visit>
void ClipField::walk(const DepthLine& line, const Lattice& lattice, double z_begin, double z_end,
                     const Visit& visit) const {
  const auto plane = [&](int axis, std::int64_t index) {
    const std::int64_t last = grid_->data.shape.dimensions[axis] - 1;
    return static_cast<double>(frame_.plane(axis, std::min(last, lattice.first[axis] + index * lattice.stride)));
  };
  Index at{};
  std::array<double, 3> z_leave{};
  const auto find_leave = [&](int axis) {
    const double direction = line.direction[axis];
    z_leave[axis] = direction == 0.0 ? std::numeric_limits<double>::infinity()
                                     : (plane(axis, at[axis] + (direction > 0.0)) - line.origin[axis]) / direction;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const double start = line.origin[axis] + z_begin * line.direction[axis];
    if (frame_.planes[axis].empty())
      at[axis] = static_cast<std::int64_t>(
          std::floor((start - static_cast<double>(lattice.first[axis])) / static_cast<double>(lattice.stride)));
    else
      while (at[axis] + 1 < lattice.count[axis] && plane(axis, at[axis] + 1) <= start) ++at[axis];
    at[axis] = std::clamp(at[axis], std::int64_t{0}, lattice.count[axis] - 1);
    find_leave(axis);
  }
  for (double z = z_begin; z < z_end;) {
    const int axis = static_cast<int>(std::min_element(z_leave.begin(), z_leave.end()) - z_leave.begin());
    // Planes at the upper end may be passed a little late: what is left belongs to the last box.
    const std::int64_t next = at[axis] + (line.direction[axis] > 0.0 ? 1 : -1);
    const bool is_last = next < 0 || next >= lattice.count[axis];
    const double z_next = is_last ? z_end : std::clamp(z_leave[axis], z, z_end);
    if (z < z_next) visit(at, z, z_next);
    if (is_last) return;
    z = z_next;
    at[axis] = next;
    find_leave(axis);
  }
}

const float* ClipField::values_of(const Index& brick, std::uint32_t index, Cache& cache) const {
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
  if (!cut_with_bounds(line, z_begin, z_end)) return;
  const BrickSummaries& bricks = grid_->bricks;
  Lattice lattice;
  lattice.stride = kBrickCells;
  for (int axis = 0; axis < 3; ++axis) lattice.count[axis] = bricks.counts[axis];
  walk(line, lattice, z_begin, z_end, [&](const Index& at, double z_near, double z_far) {
    const auto index = static_cast<std::uint32_t>((at[2] * lattice.count[1] + at[1]) * lattice.count[0] + at[0]);
    if (bricks.max[index] < threshold_) return;
    if (bricks.min[index] >= threshold_ && !bricks.has_missing[index])
      append_range(ranges, z_near, z_far);
    else
      find_in_brick(line, at, values_of(at, index, cache), z_near, z_far, ranges);
  });
}

void ClipField::find_in_brick(const DepthLine& line, const Index& brick, const float* values, double z_begin,
                              double z_end, DepthRanges& ranges) const {
  Lattice lattice;
  Index nodes{};
  for (int axis = 0; axis < 3; ++axis) {
    lattice.first[axis] = brick[axis] * kBrickCells;
    lattice.count[axis] =
        std::min<std::int64_t>(kBrickCells, grid_->data.shape.dimensions[axis] - 1 - lattice.first[axis]);
    nodes[axis] = lattice.count[axis] + (is_point_ ? 1 : 0);
  }
  walk(line, lattice, z_begin, z_end, [&](const Index& at, double z_near, double z_far) {
    const float* first = values + (at[2] * nodes[1] + at[1]) * nodes[0] + at[0];
    if (!is_point_) {
      if (*first >= threshold_) append_range(ranges, z_near, z_far);
      return;
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
    if (is_missing || inside == 0) return;
    if (inside == 8)
      append_range(ranges, z_near, z_far);
    else
      find_in_cell(line, {lattice.first[0] + at[0], lattice.first[1] + at[1], lattice.first[2] + at[2]}, corners,
                   z_near, z_far, ranges);
  });
}

void ClipField::find_in_cell(const DepthLine& line, const Index& cell, const std::array<float, 8>& corners,
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
