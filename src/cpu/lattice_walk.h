#pragma once

/// Lines through lattices of boxes, one line at a time.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetravox::cpu {

/// Depths [begin, end), begin < end.
struct DepthRange {
  double begin = 0.0, end = 0.0;
};

/// Sorted; none touches the next.
using DepthRanges = std::vector<DepthRange>;

/// Appends a range that begins where the last one ends, or later. One that touches the last becomes part of it; one
/// without length is left out.
inline void append_range(DepthRanges& ranges, double begin, double end) {
  if (!(begin < end)) return;
  if (!ranges.empty() && ranges.back().end >= begin)
    ranges.back().end = end;
  else
    ranges.push_back({begin, end});
}

/// A line in any frame: origin + z * direction.
struct DepthLine {
  std::array<double, 3> origin{}, direction{};
};

using LatticeIndex = std::array<std::int64_t, 3>;

/// Cuts a range of depths with lower <= coordinate <= upper along all axes. Whether anything is left.
inline bool cut_with_box(const DepthLine& line, const std::array<double, 3>& lower, const std::array<double, 3>& upper,
                         double& z_begin, double& z_end) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double origin = line.origin[axis], direction = line.direction[axis];
    if (direction == 0.0) {
      if (!(origin >= lower[axis] && origin <= upper[axis])) return false;
      continue;
    }
    const double low = (lower[axis] - origin) / direction, high = (upper[axis] - origin) / direction;
    z_begin = std::max(z_begin, std::min(low, high));
    z_end = std::min(z_end, std::max(low, high));
  }
  return z_begin < z_end;
}

/// Calls `visit(index, z_begin, z_end)` for the boxes of a lattice that a line meets, in order (Amanatides and Woo
/// 1987), until that returns false. The line lies in the lattice for these depths, but for rounding.
///
/// A `Lattice` has std::int64_t count(axis); double plane(axis, index), the lower plane of a box; and std::int64_t
/// find(axis, coordinate), the box that holds a coordinate, about: it is clamped.
template <class Lattice, class Visit>
void walk_lattice(const DepthLine& line, const Lattice& lattice, double z_begin, double z_end, const Visit& visit) {
  LatticeIndex at{};
  std::array<double, 3> z_leave{}, inverse{};
  const auto find_leave = [&](std::size_t axis) {
    const double direction = line.direction[axis];
    if (direction == 0.0) return;
    z_leave[axis] = (lattice.plane(axis, at[axis] + (direction > 0.0)) - line.origin[axis]) * inverse[axis];
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double start = line.origin[axis] + z_begin * line.direction[axis];
    inverse[axis] = 1.0 / line.direction[axis];
    z_leave[axis] = std::numeric_limits<double>::infinity();
    at[axis] = std::clamp(lattice.find(axis, start), std::int64_t{0}, lattice.count(axis) - 1);
    find_leave(axis);
  }
  for (double z = z_begin; z < z_end;) {
    const auto axis = static_cast<std::size_t>(std::min_element(z_leave.begin(), z_leave.end()) - z_leave.begin());
    // Planes at the upper end may be passed a little late: what is left belongs to the last box.
    const std::int64_t next = at[axis] + (line.direction[axis] > 0.0 ? 1 : -1);
    const bool is_last = next < 0 || next >= lattice.count(axis);
    const double z_next = is_last ? z_end : std::clamp(z_leave[axis], z, z_end);
    if (z < z_next && !visit(at, z, z_next)) return;
    if (is_last) return;
    z = z_next;
    at[axis] = next;
    find_leave(axis);
  }
}

}  // namespace tetravox::cpu
