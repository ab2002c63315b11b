#include "src/cpu/clip_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tetravox::cpu {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Goes from box to box of a lattice of boxes along a line (Amanatides and Woo 1987).
class BoxWalk {
 public:
  /// Boxes `first` ... `last` - 1 along each axis; `plane(axis, i)` is where box i begins.
  template <class Plane>
  BoxWalk(const GridLine& line, const DepthRange& depths, const std::array<std::int64_t, 3>& first,
          const std::array<std::int64_t, 3>& last, const Plane& plane)
      : z_(depths.first), end_(depths.second) {
    for (int axis = 0; axis < 3; ++axis) {
      const double at = line.origin[axis] + z_ * line.direction[axis];
      std::int64_t low = first[axis], high = last[axis];  // the box that holds `at`
      while (high - low > 1) {
        const std::int64_t middle = low + (high - low) / 2;
        const bool is_above = line.direction[axis] < 0.0 ? at > plane(axis, middle) : at >= plane(axis, middle);
        (is_above ? low : high) = middle;
      }
      index[axis] = low;
    }
  }

  bool is_done() const { return !(z_ < end_); }
  double begin() const { return z_; }

  /// Where the box at hand ends, and which axis it is left along.
  template <class Plane>
  double find_end(const GridLine& line, const Plane& plane, int& left) const {
    double next = kInfinity;
    left = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double direction = line.direction[axis];
      if (direction == 0.0) continue;
      const double z = (plane(axis, index[axis] + (direction > 0.0 ? 1 : 0)) - line.origin[axis]) / direction;
      if (z < next) {
        next = z;
        left = axis;
      }
    }
    return std::clamp(next, z_, end_);
  }
  void advance(const GridLine& line, double z, int axis) {
    index[axis] += line.direction[axis] > 0.0 ? 1 : -1;
    z_ = z;
  }

  std::array<std::int64_t, 3> index{};

 private:
  double z_, end_;
};

/// The field minus the value along a line in a cell: a cubic of t in [0, 1].
struct Cubic {
  std::array<double, 4> c{};
  double eval(double t) const { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
};

Cubic make_cubic(const std::array<float, 8>& corners, const std::array<double, 3>& from,
                 const std::array<double, 3>& to) {
  // The product of three linear weights for each corner.
  Cubic cubic;
  for (int corner = 0; corner < 8; ++corner) {
    std::array<double, 4> product{corners[corner], 0.0, 0.0, 0.0};
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_high = corner >> axis & 1;
      const double base = is_high ? from[axis] : 1.0 - from[axis];
      const double slope = is_high ? to[axis] - from[axis] : from[axis] - to[axis];
      for (int i = 3; i > 0; --i) product[i] = product[i] * base + product[i - 1] * slope;
      product[0] *= base;
    }
    for (int i = 0; i < 4; ++i) cubic.c[i] += product[i];
  }
  return cubic;
}

/// Where the cubic turns in (0, 1), ascending, between 0 and 1.
std::array<double, 4> monotone_borders(const Cubic& cubic) {
  std::array<double, 4> borders{0.0, 1.0, 1.0, 1.0};
  const double a = 3.0 * cubic.c[3], b = cubic.c[2], c = cubic.c[1];  // a t^2 + 2 b t + c
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0.0)) return borders;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  double low = a != 0.0 ? q / a : 2.0, high = q != 0.0 ? c / q : 2.0;
  if (low > high) std::swap(low, high);
  int count = 1;
  for (const double root : {low, high})
    if (root > 0.0 && root < 1.0) borders[count++] = root;
  return borders;
}

/// The crossing of a cubic that is monotone in [low, high] and changes sign there.
double find_root(const Cubic& cubic, double low, double high) {
  const bool is_low_inside = cubic.eval(low) >= 0.0;
  for (int i = 0; i < 60 && high - low > 1e-14; ++i) {
    const double middle = 0.5 * (low + high);
    ((cubic.eval(middle) >= 0.0) == is_low_inside ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

/// The parts found so far along one line.
class ClipField::Walk {
 public:
  Walk(const ClipField& field, const GridLine& line, std::vector<DepthRange>& inside)
      : field_(field), line_(line), inside_(inside), first_(inside.size()) {}

  void run() {
    const auto& dimensions = field_.grid_.data.shape.dimensions;
    DepthRange depths{-kInfinity, kInfinity};
    std::array<std::int64_t, 3> bricks{};
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = line_.origin[axis], direction = line_.direction[axis], upper = dimensions[axis] - 1.0;
      bricks[axis] = field_.grid_.bricks.counts[axis];
      if (direction == 0.0) {
        if (origin < 0.0 || origin > upper) return;
        continue;
      }
      const double a = -origin / direction, b = (upper - origin) / direction;
      depths.first = std::max(depths.first, std::min(a, b));
      depths.second = std::min(depths.second, std::max(a, b));
    }
    if (!(depths.first < depths.second)) return;
    const auto plane = [&](int axis, std::int64_t brick) {
      return static_cast<double>(
          field_.frame_.plane(axis, std::min<std::int64_t>(brick * kBrickCells, dimensions[axis] - 1)));
    };
    BoxWalk walk(line_, depths, {0, 0, 0}, bricks, plane);
    while (!walk.is_done()) {
      int axis = 0;
      const double end = walk.find_end(line_, plane, axis);
      pass_brick(walk.index, {walk.begin(), end});
      walk.advance(line_, end, axis);
      if (walk.index[axis] < 0 || walk.index[axis] >= bricks[axis]) return;
    }
  }

 private:
  void add(double begin, double end) {
    if (!(end > begin)) return;
    if (inside_.size() > first_ && inside_.back().second >= begin)
      inside_.back().second = end;
    else
      inside_.push_back({begin, end});
  }

  void pass_brick(const std::array<std::int64_t, 3>& brick, const DepthRange& depths) {
    const BrickSummaries& bricks = field_.grid_.bricks;
    const auto at = static_cast<std::size_t>((brick[2] * bricks.counts[1] + brick[1]) * bricks.counts[0] + brick[0]);
    if (!(bricks.max[at] >= field_.value_)) return;
    if (bricks.min[at] >= field_.value_ && !bricks.has_missing[at]) return add(depths.first, depths.second);
    const auto plane = [&](int axis, std::int64_t cell) {
      return static_cast<double>(field_.frame_.plane(axis, cell));
    };
    std::array<std::int64_t, 3> first{}, last{};
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = brick[axis] * kBrickCells;
      last[axis] = std::min<std::int64_t>(first[axis] + kBrickCells,
                                          static_cast<std::int64_t>(field_.grid_.data.shape.dimensions[axis]) - 1);
    }
    BoxWalk walk(line_, depths, first, last, plane);
    while (!walk.is_done()) {
      int axis = 0;
      const double end = walk.find_end(line_, plane, axis);
      pass_cell(walk.index, {walk.begin(), end});
      walk.advance(line_, end, axis);
      if (walk.index[axis] < first[axis] || walk.index[axis] >= last[axis]) return;
    }
  }

  void pass_cell(const std::array<std::int64_t, 3>& cell, const DepthRange& depths) {
    if (field_.grid_.data.association == Association::kCell) {
      float value = 0.0f;
      field_.reader_.read({cell, {1, 1, 1}}, &value);
      if (value >= field_.value_) add(depths.first, depths.second);
      return;
    }
    std::array<float, 8> corners{};
    field_.reader_.read({cell, {2, 2, 2}}, corners.data());
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
    for (const float corner : corners)
      if (!(corner == corner)) return;
    if (*high < field_.value_) return;
    if (*low >= field_.value_) return add(depths.first, depths.second);
    for (float& corner : corners) corner -= field_.value_;
    std::array<double, 3> from{}, to{};
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = field_.frame_.plane(axis, cell[axis]), upper = field_.frame_.plane(axis, cell[axis] + 1);
      const auto place = [&](double z) {
        return std::clamp((line_.origin[axis] + z * line_.direction[axis] - lower) / (upper - lower), 0.0, 1.0);
      };
      from[axis] = place(depths.first);
      to[axis] = place(depths.second);
    }
    add_crossings(make_cubic(corners, from, to), depths);
  }

  void add_crossings(const Cubic& cubic, const DepthRange& depths) {
    const auto depth_at = [&](double t) { return depths.first + t * (depths.second - depths.first); };
    const std::array<double, 4> borders = monotone_borders(cubic);
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
      const double a = borders[i], b = borders[i + 1];
      if (!(b > a)) continue;
      const bool starts_inside = cubic.eval(a) >= 0.0, ends_inside = cubic.eval(b) >= 0.0;
      if (!starts_inside && !ends_inside) continue;
      const double root = starts_inside == ends_inside ? b : find_root(cubic, a, b);
      add(depth_at(starts_inside ? a : root), depth_at(starts_inside ? root : b));
    }
  }

  const ClipField& field_;
  const GridLine& line_;
  std::vector<DepthRange>& inside_;
  std::size_t first_;
};

ClipField::ClipField(const PreparedGrid& grid, double value)
    : grid_(grid),
      frame_(grid::make_grid_frame(grid.data.shape)),
      reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}),
      value_(static_cast<float>((value - grid.scalar_offset) / grid.scalar_scale)) {}

void ClipField::find_inside(const GridLine& line, std::vector<DepthRange>& inside) const {
  Walk(*this, line, inside).run();
}

}  // namespace tetravox::cpu
