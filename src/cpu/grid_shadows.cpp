#include "src/cpu/grid_shadows.h"

#include "src/cpu/cell_cubic.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::cpu {
namespace {

/// The cells of a brick, for `walk_lattice`. Of even bricks in coordinates that count them from the lower corner.
struct EvenCells {
  const MarchBrick& brick;

  std::int64_t count(std::size_t axis) const { return brick.cells[axis]; }
  double plane(std::size_t, std::int64_t index) const { return static_cast<double>(index); }
  double cells_per_unit(std::size_t, std::int64_t) const { return 1.0; }
  std::int64_t find(std::size_t, double coordinate) const { return static_cast<std::int64_t>(std::floor(coordinate)); }
};
/// Of others in those of the grid.
struct UnevenCells {
  const MarchBrick& brick;

  std::int64_t count(std::size_t axis) const { return brick.cells[axis]; }
  double plane(std::size_t axis, std::int64_t index) const { return brick.planes[axis][index]; }
  double cells_per_unit(std::size_t axis, std::int64_t index) const {
    return 1.0 / (plane(axis, index + 1) - plane(axis, index));
  }
  std::int64_t find(std::size_t axis, double coordinate) const {
    const float* planes = brick.planes[axis];
    return std::upper_bound(planes, planes + brick.cells[axis] + 1, coordinate) - planes - 1;
  }
};

/// Cells of an even brick for one grid unit.
double cells_per_unit(const MarchBrick& brick, std::size_t axis) {
  return brick.cells[axis] / (static_cast<double>(brick.upper[axis]) - brick.lower[axis]);
}

/// A cell with the line in it.
struct Cell {
  const MarchBrick& brick;
  LatticeIndex index{};
  std::size_t number = 0;
  std::array<double, 8> corners{};
  std::array<double, 3> at{}, step{};  ///< in cells: where the line enters, and how far it goes
  Cubic cubic{};
};

}  // namespace

/// The bricks of a grid, for `walk_lattice`.
struct GridShadows::Bricks {
  const GridShadows& owner;

  const BrickSummaries& summaries() const { return owner.grid_.sources.grid->bricks; }
  std::int64_t count(std::size_t axis) const { return summaries().counts[axis]; }
  double plane(std::size_t axis, std::int64_t index) const {
    const std::int64_t last = owner.grid_.sources.grid->data.shape.dimensions[axis] - 1;
    return owner.grid_.frame->plane(static_cast<int>(axis), std::min(last, index * kBrickCells));
  }
  std::int64_t find(std::size_t axis, double coordinate) const {
    const std::vector<float>& planes = owner.grid_.frame->planes[axis];
    if (planes.empty()) return static_cast<std::int64_t>(std::floor(coordinate / kBrickCells));
    return (std::upper_bound(planes.begin(), planes.end(), coordinate) - planes.begin() - 1) / kBrickCells;
  }
};

/// One line through the grid.
class GridShadows::Walk {
 public:
  Walk(const GridShadows& owner, const DepthLine& line, double world_per_z, std::span<const DepthRange> kept,
       Transmission& sum)
      : owner_(owner),
        optics_(owner.optics_),
        line_(line),
        world_per_z_(world_per_z),
        kept_(kept),
        sum_(sum),
        store_(owner.stores_.local()) {}

  void run(double z_begin, double z_end) {
    const Bricks bricks{owner_};
    walk_lattice(line_, bricks, z_begin, z_end, [&](const LatticeIndex& at, double z_front, double z_back) {
      const auto index = static_cast<std::uint32_t>((at[2] * bricks.count(1) + at[1]) * bricks.count(0) + at[0]);
      if (owner_.grid_.plans[index].level == scene::BrickPlan::kTransparent) return true;
      pass_brick(index, z_front, z_back);
      return !optics_.is_dark(sum_);
    });
  }

 private:
  using Mark = optics::ExtinctionIntegral::Mark;

  void pass_brick(std::uint32_t index, double z_front, double z_back) {
    const scene::PlanSources& sources = owner_.grid_.sources;
    const ValueRange range = range_of(sources, index);
    const bool has_missing =
        sources.grid->missing_values > 0 && (sources.field->kernel || sources.grid->bricks.has_missing[index] != 0);
    if (range.min == range.max && !has_missing) {
      pass_constant(range.min, z_front, z_back);
      return;
    }
    const MarchBrick& brick = store_.find(owner_.grid_, index);
    if (brick.is_uneven) {
      pass_cells(line_, UnevenCells{brick}, z_front, z_back);
      return;
    }
    DepthLine line = line_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double scale = cells_per_unit(brick, axis);
      line.origin[axis] = (line.origin[axis] - brick.lower[axis]) * scale;
      line.direction[axis] *= scale;
    }
    pass_cells(line, EvenCells{brick}, z_front, z_back);
  }

  template <class Cells>
  void pass_cells(const DepthLine& line, const Cells& cells, double z_front, double z_back) {
    walk_lattice(line, cells, z_front, z_back, [&](const LatticeIndex& at, double z_near, double z_far) {
      Cell cell{cells.brick};
      cell.number = static_cast<std::size_t>((at[2] * cells.count(1) + at[1]) * cells.count(0) + at[0]);
      cell.index = at;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double lower = cells.plane(axis, at[axis]), scale = cells.cells_per_unit(axis, at[axis]);
        const auto place = [&](double z) {
          return std::clamp((line.origin[axis] + z * line.direction[axis] - lower) * scale, 0.0, 1.0);
        };
        cell.at[axis] = place(z_near);
        cell.step[axis] = place(z_far) - cell.at[axis];
      }
      pass_cell(cell, z_near, z_far);
      return !optics_.is_dark(sum_);
    });
  }

  /// Where the field does not change, neither light nor weights by gradient need look at it.
  void pass_constant(double scalar, double z_front, double z_back) {
    const Mark mark = optics_.extinction->mark(scalar);
    visit_kept(kept_, z_front, z_back, [&](double begin, double end) {
      add_extinction(optics_, {mark, mark, (end - begin) * world_per_z_, 0.0}, sum_);
    });
    leave(z_back, mark);
  }

  void pass_cell(Cell& cell, double z_front, double z_back) {
    const MarchBrick& brick = cell.brick;
    if (brick.constants) {
      const float scalar = brick.constants[cell.number];
      if (scalar != scalar) return;
      cell.cubic = {scalar, 0.0, 0.0, 0.0};
      absorb(cell, z_front, z_back);
      return;
    }
    const float* low = brick.records + 4 * cell.number;
    const float* high = low + 4 * static_cast<std::ptrdiff_t>(brick.cells[0]) * brick.cells[1];
    double sum = 0.0;
    for (std::size_t i = 0; i < 8; ++i) sum += cell.corners[i] = i < 4 ? low[i] : high[i - 4];
    if (sum != sum) return;  // a corner is missing
    cell.cubic = make_cubic(cell.corners, cell.at, cell.step);
    absorb(cell, z_front, z_back);
  }

  void absorb(const Cell& cell, double z_front, double z_back) {
    const auto mark_at = [&](double t) { return optics_.extinction->mark(eval_cubic(cell.cubic, t)); };
    // What a line meets on a face must be the same on both sides.
    const bool is_joined = z_front == z_left_ && !cell.brick.constants;
    const Mark front = is_joined ? left_ : mark_at(0.0), back = mark_at(1.0);
    const double length = (z_back - z_front) * world_per_z_;
    visit_kept(kept_, z_front, z_back, [&](double begin, double end) {
      const auto end_at = [&](double z) {
        const double t = (z - z_front) / (z_back - z_front);
        return End{t, mark_at(t)};
      };
      absorb_part(cell, begin == z_front ? End{0.0, front} : end_at(begin),
                  end == z_back ? End{1.0, back} : end_at(end), length);
    });
    leave(z_back, back);
  }

  /// A place on the way through a cell, from 0 to 1.
  struct End {
    double t = 0.0;
    Mark mark;
  };

  void absorb_part(const Cell& cell, const End& front, const End& back, double length) {
    const double bend = bend_of(cell.cubic), margin = 1.5 * bend;
    const double low = std::min(front.mark.scalar, back.mark.scalar) - margin;
    const double high = std::max(front.mark.scalar, back.mark.scalar) + margin;
    if (has_surface(low, high)) meet_surfaces(cell, front, back);
    int pieces = 1;
    if (bend * cell.brick.steepness > owner_.settings_.allowed_rate)
      pieces = count_pieces(bend, low, high, back.t - front.t);
    End at = front;
    for (int i = 1; i <= pieces; ++i) {
      const bool is_last = i == pieces;
      const double t = is_last ? back.t : front.t + (back.t - front.t) * i / pieces;
      const End next = is_last ? back : End{t, optics_.extinction->mark(eval_cubic(cell.cubic, t))};
      ShadowPiece piece{at.mark, next.mark, (next.t - at.t) * length, 0.0};
      if (optics_.weight_by_gradient > 0.0f) piece.gradient = magnitude(cell, 0.5 * (at.t + next.t));
      add_extinction(optics_, piece, sum_);
      at = next;
    }
  }

  /// Linear pieces that the tolerance asks for.
  int count_pieces(double bend, double low, double high, double part) const {
    const double steepness =
        owner_.grid_.sources.steepness->largest_steepness(static_cast<float>(low), static_cast<float>(high));
    const double wanted = std::ceil(std::sqrt(bend * steepness / owner_.settings_.allowed_rate) * part);
    return static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(owner_.settings_.most_pieces)));
  }

  bool has_surface(double low, double high) const {
    return std::any_of(optics_.surfaces.begin(), optics_.surfaces.end(),
                       [&](const SurfaceSheet& sheet) { return sheet.value >= low && sheet.value <= high; });
  }

  void meet_surfaces(const Cell& cell, const End& front, const End& back) {
    std::array<double, 4> ends;
    const int count = split_at_extrema(cell.cubic, ends);
    double scalar = front.mark.scalar;
    for (int i = 1; i < count; ++i) {
      const double t = ends[static_cast<std::size_t>(i)];
      if (t <= front.t) continue;
      const bool is_last = t >= back.t || i + 1 == count;
      const double next = is_last ? back.mark.scalar : eval_cubic(cell.cubic, t);
      add_surfaces(optics_, scalar, next, sum_);
      if (is_last) return;
      scalar = next;
    }
  }

  /// Of the gradient at `t`, as the kernels find it.
  double magnitude(const Cell& cell, double t) const {
    std::array<double, 3> at{}, gradient{};
    for (std::size_t axis = 0; axis < 3; ++axis) at[axis] = cell.at[axis] + t * cell.step[axis];
    if (cell.brick.gradients && cell.brick.constants)
      std::copy_n(cell.brick.gradients + 4 * cell.number, 3, gradient.begin());
    else if (cell.brick.gradients)
      gradient = mix_gradients(cell, at);
    else if (!cell.brick.constants)
      gradient = find_slope(cell, at);
    const auto& turn = owner_.settings_.camera_from_gradient;
    double square = 0.0;
    for (std::size_t row = 0; row < 3; ++row) {
      const double component =
          turn[3 * row] * gradient[0] + turn[3 * row + 1] * gradient[1] + turn[3 * row + 2] * gradient[2];
      square += component * component;
    }
    return std::sqrt(square);
  }

  static std::array<double, 3> mix_gradients(const Cell& cell, const std::array<double, 3>& at) {
    const auto row = static_cast<std::size_t>(cell.brick.cells[0]) + 1;
    const std::size_t slice = row * (static_cast<std::size_t>(cell.brick.cells[1]) + 1);
    const std::size_t node = static_cast<std::size_t>(cell.index[2]) * slice +
                             static_cast<std::size_t>(cell.index[1]) * row + static_cast<std::size_t>(cell.index[0]);
    std::array<double, 3> sum{};
    for (std::size_t i = 0; i < 8; ++i) {
      const std::array<std::size_t, 3> upper{i & 1, i >> 1 & 1, i >> 2};
      double weight = 1.0;
      for (std::size_t axis = 0; axis < 3; ++axis) weight *= upper[axis] ? at[axis] : 1.0 - at[axis];
      const float* gradient = cell.brick.gradients + 4 * (node + upper[0] + upper[1] * row + upper[2] * slice);
      for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += weight * gradient[axis];
    }
    return sum;
  }

  /// The derivative of the trilinear cell, in grid units.
  static std::array<double, 3> find_slope(const Cell& cell, const std::array<double, 3>& at) {
    std::array<double, 3> slope{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<double, 3> unit{};
      unit[axis] = 1.0;
      const double scale = cell.brick.is_uneven ? UnevenCells{cell.brick}.cells_per_unit(axis, cell.index[axis])
                                                : cells_per_unit(cell.brick, axis);
      slope[axis] = make_cubic(cell.corners, at, unit)[1] * scale;
    }
    return slope;
  }

  void leave(double z, const Mark& mark) {
    z_left_ = z;
    left_ = mark;
  }

  const GridShadows& owner_;
  const ShadowOptics& optics_;
  const DepthLine& line_;
  double world_per_z_;
  std::span<const DepthRange> kept_;
  Transmission& sum_;
  BrickStore& store_;
  double z_left_ = -std::numeric_limits<double>::infinity();
  Mark left_;
};

GridShadows::GridShadows(const PlannedGrid& grid, const scene::LocalFrame& local, const ShadowOptics& optics,
                         const GridShadowSettings& settings)
    : grid_(grid), local_(local), optics_(optics), settings_(settings) {
  for (int axis = 0; axis < 3; ++axis)
    upper_[axis] = grid.frame->plane(axis, grid.sources.grid->data.shape.dimensions[axis] - 1);
}

DepthLine GridShadows::grid_line(const ShadowLine& line) const {
  DepthLine found;
  const grid::GridFrame& frame = *grid_.frame;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t i = 0; i < 3; ++i) {
      const double element = frame.grid_from_world[3 * row + i];
      found.origin[row] += element * (local_.origin[i] - frame.origin[i] + local_.world_per_local * line.place[i]);
      found.direction[row] += element * local_.world_per_local * line.step[i];
    }
  return found;
}

void GridShadows::gather(const ShadowLine& line, std::span<const DepthRange> kept, Transmission& sum) const {
  const DepthLine along = grid_line(line);
  double z_begin = kept.front().begin, z_end = kept.back().end;
  if (!cut_with_box(along, {}, upper_, z_begin, z_end)) return;
  Walk(*this, along, line.world_per_z, kept, sum).run(z_begin, z_end);
}

}  // namespace tetravox::cpu
