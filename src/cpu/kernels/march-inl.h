// The source `march`: rays go from cell to cell of a brick of a grid, a vector of rays at a time.

#if defined(TETRAVOX_CPU_MARCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_MARCH_INL
#undef TETRAVOX_CPU_MARCH_INL
#else
#define TETRAVOX_CPU_MARCH_INL
#endif

#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// A ray that moves less than this along an axis, in cells for one unit of depth, is parallel to the lattice planes.
constexpr float kParallel = 1e-6f;
constexpr float kNever = 1e30f;

/// Origins and directions of a tile's rays; nothing accumulated yet.
inline void start_march(const MarchStart& start) {
  MarchRays& tile = *start.tile;
  const RayGrid& grid = *start.rays;
  const float* m = start.grid_from_camera;
  for (int row = 0; row < kTileSize; ++row) {
    const int y = std::min(start.row + row, grid.height - 1);
    const float y_offset = grid.row_offset[y], y_slope = grid.row_slope[y];
    for (int column = 0; column < kTileSize; ++column) {
      const int x = std::min(start.column + column, grid.width - 1), i = row * kTileSize + column;
      const float x_offset = grid.column_offset[x], x_slope = grid.column_slope[x];
      for (int axis = 0; axis < 3; ++axis) {
        tile.origin[axis][i] = m[4 * axis] * x_offset + m[4 * axis + 1] * y_offset + m[4 * axis + 3];
        tile.direction[axis][i] = m[4 * axis] * x_slope + m[4 * axis + 1] * y_slope + m[4 * axis + 2];
      }
      tile.world_per_z[i] = grid.world_per_local * std::sqrt(1.0f + x_slope * x_slope + y_slope * y_slope);
      const bool is_inside = start.column + column < grid.width && start.row + row < grid.height;
      tile.z_far[i] = is_inside ? kNever : -kNever;
      tile.z_exit[i] = kNever;
      for (int axis = 0; axis < 3; ++axis) {
        const float direction = tile.direction[axis][i];
        if (std::abs(direction) < kParallel) continue;
        const float inverse = 1.0f / direction;
        tile.z_exit[i] = std::min(tile.z_exit[i], std::max((0.0f - tile.origin[axis][i]) * inverse,
                                                           (start.upper[axis] - tile.origin[axis][i]) * inverse));
      }
      tile.z_sample[i] = -kNever;
      tile.red[i] = tile.green[i] = tile.blue[i] = 0.0f;
      tile.transmittance[i] = 1.0f;
    }
  }
}

/// Rays that cross about as many cells travel together: a counting sort by that number.
inline void sort_rays(MarchRays& rays, int count) {
  constexpr int kMost = 64;
  int starts[kMost + 1] = {};
  for (int i = 0; i < count; ++i) ++starts[std::min(rays.cells[i], kMost - 1) + 1];
  for (int i = 1; i <= kMost; ++i) starts[i] += starts[i - 1];
  for (int i = 0; i < count; ++i) {
    const int to = starts[std::min(rays.cells[i], kMost - 1)]++;
    rays.ray[to] = rays.unsorted_ray[i];
    rays.z_enter[to] = rays.unsorted_enter[i];
    rays.z_leave[to] = rays.unsorted_leave[i];
  }
  // The lanes beyond the last ray follow some ray.
  for (int i = count; i < count + MarchRays::kPadding; ++i) {
    rays.ray[i] = 0;
    rays.z_enter[i] = rays.z_leave[i] = 0.0f;
  }
}

/// Cuts the rays with the brick's box (Kay and Kajiya 1986). The plane between two bricks gives both the same depth, so
/// that nothing is lost or met twice.
inline int clip_brick(const MarchJob& job) {
  MarchRays& rays = *job.rays;
  const MarchBrick& brick = *job.brick;
  constexpr int kStep = static_cast<int>(kLanes);
  int count = 0;
  for (int row = brick.bounds.row_begin; row < brick.bounds.row_end; ++row)
    for (int column = brick.bounds.column_begin / kStep * kStep; column < brick.bounds.column_end; column += kStep) {
      const int first = row * kTileSize + column;
      Float enter = constant(job.z_near), leave = hn::Load(kFloat, rays.z_far + first);
      Float cells = constant(0.5f);
      for (int axis = 0; axis < 3; ++axis) {
        const Float origin = hn::Load(kFloat, rays.origin[axis] + first);
        const Float direction = hn::Load(kFloat, rays.direction[axis] + first);
        const Mask parallel = hn::Lt(hn::Abs(direction), constant(kParallel));
        const Float inverse = hn::Div(constant(1.0f), hn::IfThenElse(parallel, constant(1.0f), direction));
        const Float a = hn::Mul(hn::Sub(constant(brick.lower[axis]), origin), inverse);
        const Float b = hn::Mul(hn::Sub(constant(brick.upper[axis]), origin), inverse);
        const Mask below_end = brick.is_last[axis] ? hn::Le(origin, constant(brick.upper[axis]))
                                                   : hn::Lt(origin, constant(brick.upper[axis]));
        const Mask between = hn::And(hn::Ge(origin, constant(brick.lower[axis])), below_end);
        enter = hn::Max(enter, hn::IfThenElse(parallel, constant(-kNever), hn::Min(a, b)));
        leave = hn::Min(leave, hn::IfThenElse(parallel, hn::IfThenElse(between, constant(kNever), constant(-kNever)),
                                              hn::Max(a, b)));
        const float cells_per_unit = static_cast<float>(brick.cells[axis]) / (brick.upper[axis] - brick.lower[axis]);
        cells = multiply_add(hn::Abs(direction), constant(cells_per_unit), cells);
      }
      const Mask hit = hn::Gt(leave, enter);
      if (hn::AllFalse(kFloat, hit)) continue;
      const Int crossed = hn::ConvertTo(kInt, hn::Min(hn::Mul(cells, hn::Sub(leave, enter)), constant(1000.0f)));
      hn::CompressStore(hn::Iota(kInt, first), int_mask(hit), kInt, rays.unsorted_ray + count);
      hn::CompressStore(crossed, int_mask(hit), kInt, rays.cells + count);
      hn::CompressStore(enter, hit, kFloat, rays.unsorted_enter + count);
      count += static_cast<int>(hn::CompressStore(leave, hit, kFloat, rays.unsorted_leave + count));
    }
  if (count > 0) sort_rays(rays, count);
  return count;
}

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
  Float front, leave, world_per_z;
  Mask alive;

  /// Records are those of cells, or of nodes: `nodes_more` along each axis.
  LatticeRays(const MarchRays& rays, const MarchBrick& brick, int first, int count, int nodes_more = 0)
      : brick_(brick) {
    const Int ray = hn::Load(kInt, rays.ray + first);
    front = hn::Load(kFloat, rays.z_enter + first);
    leave = hn::Load(kFloat, rays.z_leave + first);
    alive = hn::FirstN(kFloat, static_cast<std::size_t>(count));
    world_per_z = hn::GatherIndex(kFloat, rays.world_per_z, ray);
    cell = hn::Zero(kInt);
    std::int32_t axis_stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const float n = static_cast<float>(brick.cells[axis]);
      const Float cells_per_unit = constant(n / (brick.upper[axis] - brick.lower[axis]));
      const Float origin = hn::Mul(
          hn::Sub(hn::GatherIndex(kFloat, rays.origin[axis], ray), constant(brick.lower[axis])), cells_per_unit);
      const Float direction = hn::Mul(hn::GatherIndex(kFloat, rays.direction[axis], ray), cells_per_unit);
      const Mask parallel = hn::Lt(hn::Abs(direction), hn::Mul(constant(kParallel), cells_per_unit));
      const Mask rising = hn::Ge(direction, constant(0.0f));
      const Float inverse = hn::Div(constant(1.0f), hn::IfThenElse(parallel, constant(1.0f), direction));

      const Float place = hn::Min(hn::Max(multiply_add(direction, front, origin), constant(0.0f)), constant(n));
      const Float index = hn::Min(hn::Floor(place), constant(n - 1.0f));
      const Float plane = hn::IfThenElse(rising, hn::Add(index, constant(1.0f)), index);
      next[axis] = hn::IfThenElse(parallel, constant(kNever), hn::Mul(hn::Sub(plane, origin), inverse));
      step[axis] = hn::IfThenElse(parallel, constant(kNever), hn::Abs(inverse));
      start[axis] =
          hn::IfThenElse(parallel, hn::Sub(place, index), hn::IfThenElse(rising, constant(1.0f), constant(0.0f)));
      rate[axis] = hn::IfThenElse(parallel, constant(0.0f), hn::Neg(direction));
      stride[axis] = hn::IfThenElse(int_mask(rising), hn::Set(kInt, axis_stride), hn::Set(kInt, -axis_stride));
      cell = hn::Add(cell, hn::Mul(hn::ConvertTo(kInt, index), hn::Set(kInt, axis_stride)));
      axis_stride *= brick.cells[axis] + nodes_more;
    }
    last_cell = hn::Set(kInt, axis_stride - 1);
    if (brick.is_uneven) start_uneven(rays, ray, nodes_more);
  }

  /// Depth at which the rays leave their cells.
  HWY_INLINE Float back() const { return hn::Max(hn::Min(hn::Min(hn::Min(next[0], next[1]), next[2]), leave), front); }

  /// On to the next cell.
  HWY_INLINE void advance(Float back) {
    const Mask x = hn::And(hn::Le(next[0], next[1]), hn::Le(next[0], next[2]));
    const Mask y = hn::AndNot(x, hn::Le(next[1], next[2]));
    const Mask z = hn::Not(hn::Or(x, y));
    const Mask crossed[3] = {x, y, z};
    for (int axis = 0; axis < 3; ++axis) {
      next[axis] = hn::Add(next[axis], hn::IfThenElseZero(crossed[axis], step[axis]));
      cell = hn::Add(cell, hn::IfThenElseZero(int_mask(crossed[axis]), stride[axis]));
    }
    if (brick_.is_uneven) advance_uneven(crossed);
    // Rounding may carry a ray a hair beyond the brick: stay in cells that exist.
    cell = hn::Min(hn::Max(cell, hn::Zero(kInt)), last_cell);
    alive = hn::And(alive, hn::Lt(back, leave));
    front = back;
  }

  /// Place in the cell along an axis, in [0, 1].
  HWY_INLINE Float place(int axis, Float depth) const {
    const Float at = multiply_add(hn::Sub(next[axis], depth), rate[axis], start[axis]);
    return hn::Min(hn::Max(at, constant(0.0f)), constant(1.0f));
  }

 private:
  /// Finds the cells again where the planes are not equally spaced.
  HWY_NOINLINE void start_uneven(const MarchRays& rays, Int ray, int nodes_more) {
    cell = hn::Zero(kInt);
    std::int32_t axis_stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      origins[axis] = hn::GatherIndex(kFloat, rays.origin[axis], ray);
      directions[axis] = hn::GatherIndex(kFloat, rays.direction[axis], ray);
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

/// The corners of the cells that a vector of rays is in.
struct CellCorners {
  Record low, high;

  HWY_INLINE CellCorners(const MarchBrick& brick, Int cell) {
    low = load_records(brick.records, hn::BitCast(kUint, cell));
    high = load_records(brick.records + 4 * static_cast<std::ptrdiff_t>(brick.cells[0]) * brick.cells[1],
                        hn::BitCast(kUint, cell));
  }

  /// The trilinear field at a depth.
  HWY_INLINE Float eval(const LatticeRays& rays, Float depth) const {
    const Float x = rays.place(0, depth), y = rays.place(1, depth), z = rays.place(2, depth);
    const auto mix = [](Float t, Float a, Float b) { return multiply_add(t, hn::Sub(b, a), a); };
    const auto mix_square = [&](const Record& r) { return mix(y, mix(x, r.x, r.y), mix(x, r.z, r.w)); };
    return mix(z, mix_square(low), mix_square(high));
  }

  HWY_INLINE Mask is_missing() const {
    const auto sum = [](const Record& r) { return hn::Add(hn::Add(r.x, r.y), hn::Add(r.z, r.w)); };
    const Float all = hn::Add(sum(low), sum(high));
    return hn::Ne(all, all);
  }
};

/// What a vector of rays has gathered so far.
inline Accumulated load_accumulated(const MarchRays& rays, Int ray) {
  return {hn::GatherIndex(kFloat, rays.red, ray), hn::GatherIndex(kFloat, rays.green, ray),
          hn::GatherIndex(kFloat, rays.blue, ray), hn::GatherIndex(kFloat, rays.transmittance, ray)};
}

inline void store_accumulated(const Accumulated& sum, const MarchJob& job, int first, int count) {
  MarchRays& rays = *job.rays;
  HWY_ALIGN float values[4][kLanes];
  HWY_ALIGN std::int32_t ended[kLanes];
  hn::Store(sum.red, kFloat, values[0]);
  hn::Store(sum.green, kFloat, values[1]);
  hn::Store(sum.blue, kFloat, values[2]);
  hn::Store(sum.transmittance, kFloat, values[3]);
  const Mask settled = job.use_early_ray_termination ? is_settled(sum) : hn::FirstN(kFloat, 0);
  hn::Store(hn::IfThenElseZero(int_mask(settled), hn::Set(kInt, 1)), kInt, ended);
  for (int i = 0; i < count; ++i) {
    const std::int32_t ray = rays.ray[first + i];
    rays.red[ray] = values[0][i];
    rays.green[ray] = values[1][i];
    rays.blue[ray] = values[2][i];
    rays.transmittance[ray] = values[3][i];
    if (ended[i]) rays.z_far[ray] = -kNever;
  }
}

/// Trilinear cells.
template <class Integrator>
class Marcher {
 public:
  explicit Marcher(const MarchJob& job) : job_(job), brick_(*job.brick), integrator_(*job.tables) {}

  std::uint64_t run(int count) {
    for (int first = 0; first < count; first += static_cast<int>(kLanes))
      march(first, std::min(count - first, static_cast<int>(kLanes)));
    return segments_;
  }

 private:
  /// Takes rays [first, first + count) through the brick.
  void march(int first, int count) {
    LatticeRays rays(*job_.rays, brick_, first, count);
    Accumulated sum = load_accumulated(*job_.rays, hn::Load(kInt, job_.rays->ray + first));
    Float scalar_front = CellCorners(brick_, rays.cell).eval(rays, rays.front);
    scalar_front = hn::IfThenElse(hn::Eq(scalar_front, scalar_front), scalar_front, constant(0.0f));
    auto front = integrator_.front_at(scalar_front);
    while (!hn::AllFalse(kFloat, rays.alive)) {
      segments_ += hn::CountTrue(kFloat, rays.alive);
      const CellCorners corners(brick_, rays.cell);
      const Float back = rays.back();
      Segments segment{scalar_front, corners.eval(rays, back),
                       hn::IfThenElseZero(rays.alive, hn::Mul(hn::Sub(back, rays.front), rays.world_per_z))};
      if (brick_.has_missing) leave_out_missing(corners, rays, segment, front);
      if (brick_.steepness > 0.0f)
        integrate_curve(corners, rays, back, segment, front, sum);
      else
        integrator_.integrate(segment, front, sum);
      scalar_front = segment.scalar_back;
      rays.advance(back);
    }
    store_accumulated(sum, job_, first, count);
  }

  /// A cell with a corner that is missing is transparent; behind it the ray sets out anew.
  HWY_NOINLINE void leave_out_missing(const CellCorners& corners, const LatticeRays& rays, Segments& segment,
                                      typename Integrator::Front& front) const {
    const Mask missing = corners.is_missing();
    const auto present = [&](Float value) { return hn::IfThenZeroElse(missing, value); };
    segment.scalar_front = present(corners.eval(rays, rays.front));
    segment.scalar_back = present(segment.scalar_back);
    segment.length = present(segment.length);
    front = integrator_.front_at(segment.scalar_front);
  }

  /// Integrates the cubic that the scalar is along a ray, in as many linear pieces as its distance from the chord and
  /// the steepness of the function ask for.
  HWY_INLINE void integrate_curve(const CellCorners& corners, const LatticeRays& rays, Float back, Segments& segment,
                                  typename Integrator::Front& front, Accumulated& sum) const {
    // A cubic that keeps to its chord at both thirds is its chord.
    const auto at = [&](float t) { return multiply_add(constant(t), hn::Sub(back, rays.front), rays.front); };
    const Float first = corners.eval(rays, at(1.0f / 3.0f)), second = corners.eval(rays, at(2.0f / 3.0f));
    const Float third = hn::Mul(constant(1.0f / 3.0f), hn::Sub(segment.scalar_back, segment.scalar_front));
    const Float distance = hn::Max(hn::AbsDiff(first, hn::Add(segment.scalar_front, third)),
                                   hn::AbsDiff(second, hn::Sub(segment.scalar_back, third)));
    const Float bend = hn::IfThenElseZero(hn::Gt(segment.length, constant(0.0f)), distance);
    const Mask bent = hn::Gt(hn::Mul(bend, constant(brick_.steepness)), constant(job_.allowed_rate));
    if (HWY_LIKELY(hn::AllFalse(kFloat, bent)))
      integrator_.integrate(segment, front, sum);
    else
      integrate_pieces(corners, rays, back, bend, segment, front, sum);
  }

  HWY_NOINLINE void integrate_pieces(const CellCorners& corners, const LatticeRays& rays, Float back, Float bend,
                                     const Segments& segment, typename Integrator::Front& front,
                                     Accumulated& sum) const {
    const Float low = hn::Min(segment.scalar_front, segment.scalar_back);
    const Float high = hn::Max(segment.scalar_front, segment.scalar_back);
    const Float rate = hn::Mul(
        bend, find_steepness(hn::Sub(low, hn::Mul(bend, constant(1.5f))), multiply_add(bend, constant(1.5f), high)));
    const Float pieces =
        hn::Min(hn::Max(hn::Ceil(hn::Sqrt(hn::Mul(rate, constant(1.0f / job_.allowed_rate)))), constant(1.0f)),
                constant(job_.most_pieces));
    const Float share = hn::Div(constant(1.0f), pieces);
    const Float depth = hn::Sub(back, rays.front);
    Segments piece{segment.scalar_front, segment.scalar_front, hn::Zero(kFloat)};
    Float from = hn::Zero(kFloat), number = constant(1.0f);
    for (;;) {
      const Mask last = hn::Ge(number, pieces);
      const Float to = hn::IfThenElse(last, constant(1.0f), hn::Mul(number, share));
      piece.scalar_back =
          hn::IfThenElse(last, segment.scalar_back, corners.eval(rays, multiply_add(depth, to, rays.front)));
      piece.scalar_back =
          hn::IfThenElse(hn::Eq(piece.scalar_back, piece.scalar_back), piece.scalar_back, segment.scalar_back);
      piece.length = hn::Mul(segment.length, hn::Sub(to, from));
      integrator_.integrate(piece, front, sum);
      if (hn::AllTrue(kFloat, last)) return;
      piece.scalar_front = piece.scalar_back;
      from = to;
      number = hn::Add(number, constant(1.0f));
    }
  }

  /// Largest change of density with the scalar over a range (see optics::SteepnessTable).
  HWY_INLINE Float find_steepness(Float low, Float high) const {
    const optics::SteepnessTable& table = *job_.steepness;
    const auto bin = [&](Float scalar) {
      const Float at = hn::Mul(hn::Sub(scalar, constant(table.first)), constant(table.bins_per_scalar));
      return hn::ConvertTo(kInt, hn::Min(hn::Max(at, constant(0.0f)), constant(optics::SteepnessTable::kBins - 1)));
    };
    const Int first = bin(low), last = bin(high);
    const Int count = hn::Add(hn::Sub(last, first), hn::Set(kInt, 1));
    // The exponent of a float is the logarithm of the number.
    const Int level = hn::Sub(hn::ShiftRight<23>(hn::BitCast(kInt, hn::ConvertTo(kFloat, count))), hn::Set(kInt, 127));
    const Int width = hn::BitCast(kInt, hn::ShiftLeft<23>(hn::Add(level, hn::Set(kInt, 127))));
    const Int bins = hn::ConvertTo(kInt, hn::BitCast(kFloat, width));
    const Int row = hn::Mul(level, hn::Set(kInt, optics::SteepnessTable::kBins));
    const float* values = table.steepness.data();
    const Int end = hn::Add(hn::Sub(last, bins), hn::Set(kInt, 1));
    return hn::Max(hn::GatherIndex(kFloat, values, hn::Add(row, first)),
                   hn::GatherIndex(kFloat, values, hn::Add(row, end)));
  }

  const MarchJob& job_;
  const MarchBrick& brick_;
  Integrator integrator_;
  std::uint64_t segments_ = 0;
};

/// Constant cells.
inline std::uint64_t march_cells(const MarchJob& job, int count) {
  const MarchBrick& brick = *job.brick;
  const CellIntegrator integrator(*job.tables);
  CellIntegrator::Front front;
  std::uint64_t segments = 0;
  for (int first = 0; first < count; first += static_cast<int>(kLanes)) {
    const int lanes = std::min(count - first, static_cast<int>(kLanes));
    LatticeRays rays(*job.rays, brick, first, lanes);
    Accumulated sum = load_accumulated(*job.rays, hn::Load(kInt, job.rays->ray + first));
    while (!hn::AllFalse(kFloat, rays.alive)) {
      segments += hn::CountTrue(kFloat, rays.alive);
      const Float value = hn::GatherIndex(kFloat, brick.constants, rays.cell);
      const Mask present = hn::And(rays.alive, hn::Eq(value, value));
      const Float scalar = hn::IfThenElseZero(hn::Eq(value, value), value);
      const Float back = rays.back();
      const Segments segment{scalar, scalar,
                             hn::IfThenElseZero(present, hn::Mul(hn::Sub(back, rays.front), rays.world_per_z))};
      integrator.integrate(segment, front, sum);
      rays.advance(back);
    }
    store_accumulated(sum, job, first, lanes);
  }
  return segments;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
