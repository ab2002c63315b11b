// The source `march`: rays go from cell to cell of a brick of a grid, a vector of rays at a time.

#if defined(TETRAVOX_CPU_MARCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_MARCH_INL
#undef TETRAVOX_CPU_MARCH_INL
#else
#define TETRAVOX_CPU_MARCH_INL
#endif

#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/lattice-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

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
