// Rays in the lattice of cells of a brick.

#if defined(TETRAVOX_CPU_LATTICE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_LATTICE_INL
#undef TETRAVOX_CPU_LATTICE_INL
#else
#define TETRAVOX_CPU_LATTICE_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// A ray that moves less than this along an axis, in cells for one unit of depth, is parallel to the lattice planes.
constexpr float kParallel = 1e-6f;
constexpr float kNever = 1e30f;

/// By what part of itself a depth may be off.
constexpr float kRoundedDepth = 4e-6f;

/// Where a vector of rays comes from and goes to. Grid coordinates.
struct Course {
  Float origin[3], direction[3], world_per_z;

  HWY_INLINE Course(const MarchRays& rays, int first) {
    const Uint ray = hn::BitCast(kUint, hn::LoadU(kInt, rays.met.ray + first));
    const Record start = load_table_records(rays.start, ray), course = load_table_records(rays.course, ray);
    origin[0] = start.x;
    origin[1] = start.y;
    origin[2] = start.z;
    world_per_z = start.w;
    direction[0] = course.x;
    direction[1] = course.y;
    direction[2] = course.z;
  }
};

/// A vector of rays in a lattice of cells. Lattice coordinates count the cells from the brick's lower corner.
///
/// Along each axis a ray meets the planes between cells at equal steps (Amanatides and Woo 1987); from the depth at
/// which it will meet the next one follows where in the cell it is.
struct LatticeRays {
  Float next[3];   ///< depth at the next plane of each axis
  Float step[3];   ///< depth from plane to plane
  Float start[3];  ///< place in the cell = start + (next - depth) * rate
  Float rate[3];
  Int stride[3];  ///< from cell to cell, in records
  Int cell;       ///< record at hand
  Float front, leave, leave_soon, world_per_z;
  Float last_soon[3];  ///< depth half a step before the brick's last plane of each axis; of even lattices
  Mask alive;

  /// Records are those of cells, or of nodes: `nodes_more` along each axis.
  LatticeRays(const MarchRays& rays, const MarchBrick& brick, int first, int count, int nodes_more = 0)
      : brick_(brick) {
    const MarchRays::Met& met = rays.met;
    front = hn::LoadU(kFloat, met.z_enter + first);
    leave = hn::LoadU(kFloat, met.z_leave + first);
    leave_soon = hn::Sub(leave, hn::Mul(constant(kRoundedDepth), hn::Abs(leave)));
    alive = hn::FirstN(kFloat, static_cast<std::size_t>(count));
    const Course course(rays, first);
    world_per_z = course.world_per_z;
    cell = hn::Zero(kInt);
    std::int32_t axis_stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const float n = static_cast<float>(brick.cells[axis]);
      const Float cells_per_unit = constant(n / (brick.upper[axis] - brick.lower[axis]));
      const Float origin = hn::Mul(hn::Sub(course.origin[axis], constant(brick.lower[axis])), cells_per_unit);
      const Float direction = hn::Mul(course.direction[axis], cells_per_unit);
      const Mask parallel = hn::Lt(hn::Abs(direction), hn::Mul(constant(kParallel), cells_per_unit));
      const Mask rising = hn::Ge(direction, constant(0.0f));
      const Float inverse = hn::Div(constant(1.0f), hn::IfThenElse(parallel, constant(1.0f), direction));

      const Float place = hn::Min(hn::Max(multiply_add(direction, front, origin), constant(0.0f)), constant(n));
      const Float index = hn::Min(hn::Floor(place), constant(n - 1.0f));
      const Float plane = hn::IfThenElse(rising, hn::Add(index, constant(1.0f)), index);
      next[axis] = hn::IfThenElse(parallel, constant(kNever), hn::Mul(hn::Sub(plane, origin), inverse));
      step[axis] = hn::IfThenElse(parallel, constant(kNever), hn::Abs(inverse));
      const Float last = hn::IfThenElse(rising, constant(n - 0.5f), constant(0.5f));
      last_soon[axis] = hn::IfThenElse(parallel, constant(kNever), hn::Mul(hn::Sub(last, origin), inverse));
      start[axis] =
          hn::IfThenElse(parallel, hn::Sub(place, index), hn::IfThenElse(rising, constant(1.0f), constant(0.0f)));
      rate[axis] = hn::IfThenElse(parallel, constant(0.0f), hn::Neg(direction));
      stride[axis] = hn::IfThenElse(int_mask(rising), hn::Set(kInt, axis_stride), hn::Set(kInt, -axis_stride));
      cell = hn::Add(cell, hn::Mul(hn::ConvertTo(kInt, index), hn::Set(kInt, axis_stride)));
      axis_stride *= brick.cells[axis] + nodes_more;
    }
    last_cell = hn::Set(kInt, axis_stride - 1);
    if (brick.is_uneven) start_uneven(course, nodes_more);
  }

  /// Depth at which the rays leave their cells. What would remain to the brick's end by rounding alone belongs to the
  /// last cell.
  HWY_INLINE Float back() const {
    const Float plane = hn::Min(hn::Min(next[0], next[1]), next[2]);
    return hn::Max(hn::IfThenElse(hn::Lt(plane, leave_soon), plane, leave), front);
  }

  /// On to the next cell. Rounding may carry a ray past the brick's last plane of an axis a hair before it leaves:
  /// where that matters, it `kStaysInside` the cell before that plane.
  template <bool kStaysInside = false>
  HWY_INLINE void advance(Float back) {
    const Mask x = hn::And(hn::Le(next[0], next[1]), hn::Le(next[0], next[2]));
    const Mask y = hn::AndNot(x, hn::Le(next[1], next[2]));
    const Mask z = hn::Not(hn::Or(x, y));
    Mask crossed[3] = {x, y, z}, stays[3];
    if constexpr (kStaysInside) {
      for (int axis = 0; axis < 3; ++axis) {
        stays[axis] = hn::And(crossed[axis], is_before_last_plane(axis));
        crossed[axis] = hn::AndNot(stays[axis], crossed[axis]);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      next[axis] = hn::Add(next[axis], hn::IfThenElseZero(crossed[axis], step[axis]));
      cell = hn::Add(cell, hn::IfThenElseZero(int_mask(crossed[axis]), stride[axis]));
    }
    if (brick_.is_uneven) advance_uneven(crossed);
    if constexpr (kStaysInside)
      for (int axis = 0; axis < 3; ++axis) next[axis] = hn::IfThenElse(stays[axis], leave, next[axis]);
    // Stay in cells that exist.
    cell = hn::Min(hn::Max(cell, hn::Zero(kInt)), last_cell);
    alive = hn::And(alive, hn::Lt(back, leave));
    front = back;
  }

  /// Place in the cell along an axis, in [0, 1].
  HWY_INLINE Float place(int axis, Float depth) const {
    const Float at = multiply_add(hn::Sub(next[axis], depth), rate[axis], start[axis]);
    return hn::Min(hn::Max(at, constant(0.0f)), constant(1.0f));
  }

  /// Sides of the cells at hand, in grid coordinates.
  HWY_INLINE void find_cell_size(Float size[3]) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!brick_.is_uneven) {
        size[axis] = constant((brick_.upper[axis] - brick_.lower[axis]) / static_cast<float>(brick_.cells[axis]));
        continue;
      }
      const Int index = hn::Min(hn::Max(indices[axis], hn::Zero(kInt)), hn::Set(kInt, brick_.cells[axis] - 1));
      size[axis] = hn::Sub(hn::GatherIndex(kFloat, brick_.planes[axis] + 1, index),
                           hn::GatherIndex(kFloat, brick_.planes[axis], index));
    }
  }

 private:
  /// Finds the cells again where the planes are not equally spaced.
  HWY_NOINLINE void start_uneven(const Course& course, int nodes_more) {
    cell = hn::Zero(kInt);
    std::int32_t axis_stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      origins[axis] = course.origin[axis];
      directions[axis] = course.direction[axis];
      const Float at = multiply_add(directions[axis], front, origins[axis]);
      indices[axis] = hn::Zero(kInt);
      for (int i = 1; i < brick_.cells[axis]; ++i)
        indices[axis] =
            hn::Add(indices[axis],
                    hn::IfThenElseZero(int_mask(hn::Ge(at, constant(brick_.planes[axis][i]))), hn::Set(kInt, 1)));
      find_plane(axis);
      const Mask parallel = hn::Lt(hn::Abs(directions[axis]), constant(kParallel));
      const Float low = hn::GatherIndex(kFloat, brick_.planes[axis], indices[axis]);
      const Float high = hn::GatherIndex(kFloat, brick_.planes[axis] + 1, indices[axis]);
      const Float place = hn::Div(hn::Sub(at, low), hn::Sub(high, low));
      start[axis] = hn::IfThenElse(parallel, place, start[axis]);
      cell = hn::Add(cell, hn::Mul(indices[axis], hn::Set(kInt, axis_stride)));
      axis_stride *= brick_.cells[axis] + nodes_more;
    }
  }

  /// Whether the next plane of an axis is the brick's last.
  HWY_INLINE Mask is_before_last_plane(int axis) const {
    if (!brick_.is_uneven) return hn::Gt(next[axis], last_soon[axis]);
    const Mask rising = hn::Ge(directions[axis], constant(0.0f));
    const Int last = hn::IfThenElseZero(int_mask(rising), hn::Set(kInt, brick_.cells[axis] - 1));
    return hn::RebindMask(kFloat, hn::Eq(indices[axis], last));
  }

  HWY_NOINLINE void advance_uneven(const Mask crossed[3]) {
    for (int axis = 0; axis < 3; ++axis) {
      const Mask rising = hn::Ge(directions[axis], constant(0.0f));
      const Int sign = hn::IfThenElse(int_mask(rising), hn::Set(kInt, 1), hn::Set(kInt, -1));
      indices[axis] = hn::Add(indices[axis], hn::IfThenElseZero(int_mask(crossed[axis]), sign));
      find_plane(axis);
    }
  }

  /// The next plane, and how fast the place in the cell changes.
  HWY_INLINE void find_plane(int axis) {
    const Mask parallel = hn::Lt(hn::Abs(directions[axis]), constant(kParallel));
    const Mask rising = hn::Ge(directions[axis], constant(0.0f));
    const Int last = hn::Set(kInt, brick_.cells[axis] - 1);
    const Int index = hn::Min(hn::Max(indices[axis], hn::Zero(kInt)), last);
    const Mask beyond = hn::RebindMask(kFloat, hn::Ne(index, indices[axis]));  // by rounding, at the brick's end
    const Float low = hn::GatherIndex(kFloat, brick_.planes[axis], index);
    const Float high = hn::GatherIndex(kFloat, brick_.planes[axis] + 1, index);
    const Float direction = hn::IfThenElse(parallel, constant(1.0f), directions[axis]);
    const Float depth = hn::Div(hn::Sub(hn::IfThenElse(rising, high, low), origins[axis]), direction);
    next[axis] = hn::IfThenElse(hn::Or(parallel, beyond), constant(kNever), depth);
    rate[axis] = hn::IfThenElse(parallel, constant(0.0f), hn::Neg(hn::Div(direction, hn::Sub(high, low))));
  }

  const MarchBrick& brick_;
  Int last_cell;
  Float origins[3], directions[3];  // of uneven bricks, like `indices`
  Int indices[3];
};

/// See `Kernels::make_records`.
inline void make_records(const float* nodes, const std::int32_t cells[3], float* records) {
  const std::ptrdiff_t row = cells[0] + 1, slice = row * (cells[1] + 1);
  for (std::int32_t k = 0; k <= cells[2]; ++k)
    for (std::int32_t j = 0; j < cells[1]; ++j) {
      const float *low = nodes + k * slice + j * row, *high = low + row;
      for (std::int32_t i = 0; i < cells[0]; i += static_cast<std::int32_t>(kLanes))
        hn::StoreInterleaved4(hn::LoadU(kFloat, low + i), hn::LoadU(kFloat, low + i + 1), hn::LoadU(kFloat, high + i),
                              hn::LoadU(kFloat, high + i + 1), kFloat, records + 4 * i);
      records += 4 * cells[0];
    }
}

/// The corners of the cells that a vector of rays is in.
struct CellCorners {
  Record low, high;

  HWY_INLINE CellCorners(const MarchBrick& brick, Int cell) : CellCorners(brick, brick.records, cell) {}
  /// Of another field in the same lattice.
  HWY_INLINE CellCorners(const MarchBrick& brick, const float* records, Int cell) {
    low = load_table_records(records, hn::BitCast(kUint, cell));
    high = load_table_records(records + 4 * static_cast<std::ptrdiff_t>(brick.cells[0]) * brick.cells[1],
                              hn::BitCast(kUint, cell));
  }

  /// The trilinear field at a depth.
  HWY_INLINE Float eval(const LatticeRays& rays, Float depth) const {
    const Float x = rays.place(0, depth), y = rays.place(1, depth), z = rays.place(2, depth);
    return mix(z, mix_square(low, x, y), mix_square(high, x, y));
  }

  HWY_INLINE Mask is_missing() const {
    const auto sum = [](const Record& r) { return hn::Add(hn::Add(r.x, r.y), hn::Add(r.z, r.w)); };
    const Float all = hn::Add(sum(low), sum(high));
    return hn::Not(hn::Eq(all, all));  // Ne is false for what is not a number
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
