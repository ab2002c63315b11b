// The rays of a tile against the bricks of a grid: where they start, which of them meet a brick, what they have
// gathered.

#if defined(TETRAVOX_CPU_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_RAYS_INL
#undef TETRAVOX_CPU_RAYS_INL
#else
#define TETRAVOX_CPU_RAYS_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/lattice-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Origins and directions of a tile's rays; nothing accumulated yet.
inline void start_march(const MarchStart& start) {
  MarchRays& tile = *start.tile;
  const scene::RayGrid& grid = *start.rays;
  const float* m = start.grid_from_camera;
  const Float zero = constant(0.0f), one = constant(1.0f), never = constant(kNever);
  std::fill_n(tile.has_parallel, 3, false);
  std::fill_n(tile.has_met, MarchRays::kCount, std::uint8_t{0});
  std::fill_n(tile.z_near, MarchRays::kCount, grid.z_near);
  std::fill_n(tile.z_left, MarchRays::kCount, -kNever);
  std::fill_n(tile.depth, MarchRays::kCount, std::numeric_limits<float>::infinity());
  tile.has_intervals = false;
  for (int row = 0; row < kTileSize; ++row) {
    const bool is_row = start.row + row < grid.height;
    const int y = std::min(start.row + row, grid.height - 1);
    const Float y_offset = constant(grid.row_offset[y]), y_slope = constant(grid.row_slope[y]);
    for (int column = 0; column < kTileSize; column += static_cast<int>(kLanes)) {
      const int x = start.column + column, i = row * kTileSize + column;
      const int inside = is_row ? std::clamp(grid.width - x, 0, static_cast<int>(kLanes)) : 0;
      // Pixels beyond the picture repeat one that exists.
      const Float x_offset = inside > 0 ? hn::LoadU(kFloat, grid.column_offset + x) : constant(grid.column_offset[0]);
      const Float x_slope = inside > 0 ? hn::LoadU(kFloat, grid.column_slope + x) : constant(grid.column_slope[0]);
      Float origin[3], direction[3], exit = never;
      for (int axis = 0; axis < 3; ++axis) {
        const auto row_of = [&](int k) { return constant(m[4 * axis + k]); };
        origin[axis] = hn::Add(multiply_add(row_of(1), y_offset, hn::Mul(row_of(0), x_offset)), row_of(3));
        direction[axis] = hn::Add(multiply_add(row_of(1), y_slope, hn::Mul(row_of(0), x_slope)), row_of(2));
        const Mask parallel = hn::Lt(hn::Abs(direction[axis]), constant(kParallel));
        const Float inverse = hn::Div(one, hn::IfThenElse(parallel, one, direction[axis]));
        const Float near = hn::Mul(hn::Sub(zero, origin[axis]), inverse);
        const Float far = hn::Mul(hn::Sub(constant(start.upper[axis]), origin[axis]), inverse);
        exit = hn::Min(exit, hn::IfThenElse(parallel, never, hn::Max(near, far)));
        tile.has_parallel[axis] |= !hn::AllFalse(kFloat, parallel);
        hn::Store(origin[axis], kFloat, tile.origin[axis] + i);
        hn::Store(direction[axis], kFloat, tile.direction[axis] + i);
        hn::Store(inverse, kFloat, tile.inverse[axis] + i);
      }
      const Float slopes = multiply_add(y_slope, y_slope, multiply_add(x_slope, x_slope, one));
      const Float world_per_z = hn::Mul(constant(grid.world_per_local), hn::Sqrt(slopes));
      hn::StoreInterleaved4(origin[0], origin[1], origin[2], world_per_z, kFloat, tile.start[i]);
      hn::StoreInterleaved4(direction[0], direction[1], direction[2], zero, kFloat, tile.course[i]);
      hn::StoreInterleaved4(zero, zero, zero, one, kFloat, tile.sums[i]);
      const Mask visible = hn::FirstN(kFloat, static_cast<std::size_t>(inside));
      hn::Store(hn::IfThenElse(visible, never, hn::Neg(never)), kFloat, tile.z_far + i);
      hn::Store(exit, kFloat, tile.z_exit + i);
      hn::Store(hn::Neg(never), kFloat, tile.z_sample + i);
    }
  }
}

/// Part of a vector of rays that lies between two planes of an axis.
struct AxisRange {
  Float enter, leave;
};

HWY_INLINE AxisRange range_between(Float lower, Float upper, Float origin, Float inverse) {
  const Float a = hn::Mul(hn::Sub(lower, origin), inverse), b = hn::Mul(hn::Sub(upper, origin), inverse);
  return {hn::Min(a, b), hn::Max(a, b)};
}

/// Where a ray is parallel to the planes: all of it, where it `is_inside`, or nothing.
HWY_INLINE AxisRange heed_parallel(const AxisRange& range, Float direction, Mask is_inside) {
  const Float never = constant(kNever), always = constant(-kNever);
  const Mask parallel = hn::Lt(hn::Abs(direction), constant(kParallel));
  return {hn::IfThenElse(parallel, always, range.enter),
          hn::IfThenElse(parallel, hn::IfThenElse(is_inside, never, always), range.leave)};
}

HWY_INLINE AxisRange clip_axis(const MarchRays& rays, const MarchBrick& brick, int axis, int first) {
  const Float origin = hn::Load(kFloat, rays.origin[axis] + first);
  const Float inverse = hn::Load(kFloat, rays.inverse[axis] + first);
  const Float lower = constant(brick.lower[axis]), upper = constant(brick.upper[axis]);
  const AxisRange range = range_between(lower, upper, origin, inverse);
  if (HWY_LIKELY(!rays.has_parallel[axis])) return range;
  const Mask below_end = brick.is_last[axis] ? hn::Le(origin, upper) : hn::Lt(origin, upper);
  return heed_parallel(range, hn::Load(kFloat, rays.direction[axis] + first),
                       hn::And(hn::Ge(origin, lower), below_end));
}

/// Rays that cross about as many cells travel together: a counting sort by that number.
inline void sort_rays(MarchRays& rays, int count) {
  constexpr int kMost = 64;
  const MarchRays::Met& from = rays.unsorted;
  MarchRays::Met& to = rays.met;
  int starts[kMost + 1] = {};
  const auto bucket_of = [&](int i) { return std::min(from.cells[i], kMost - 1); };
  for (int i = 0; i < count; ++i) ++starts[bucket_of(i) + 1];
  for (int i = 1; i <= kMost; ++i) starts[i] += starts[i - 1];
  for (int i = 0; i < count; ++i) {
    const int place = starts[bucket_of(i)]++;
    to.ray[place] = from.ray[i];
    to.z_enter[place] = from.z_enter[i];
    to.z_leave[place] = from.z_leave[i];
  }
}

/// Writes down the rays whose clip interval ends before they leave the brick.
HWY_NOINLINE inline void note_ended(MarchRays& rays, int first, Mask ended) {
  if (hn::AllFalse(kFloat, ended)) return;
  HWY_ALIGN std::int32_t lanes[kLanes];
  hn::Store(hn::IfThenElseZero(int_mask(ended), hn::Set(kInt, 1)), kInt, lanes);
  for (std::size_t i = 0; i < kLanes; ++i)
    if (lanes[i]) rays.ended[rays.ended_count++] = first + static_cast<std::int32_t>(i);
}

/// Cuts the rays with the brick's box (Kay and Kajiya 1986) and gathers those that meet it. The plane between two
/// bricks gives both the same depth, so that nothing is lost or met twice.
inline int clip_brick(const MarchJob& job) {
  MarchRays& rays = *job.rays;
  const MarchBrick& brick = *job.brick;
  constexpr int kStep = static_cast<int>(kLanes);
  Float cells_per_unit[3];
  for (int axis = 0; axis < 3; ++axis)
    cells_per_unit[axis] = constant(static_cast<float>(brick.cells[axis]) / (brick.upper[axis] - brick.lower[axis]));
  // Many rays side by side cross about as many cells as it is.
  const TileBounds& bounds = brick.bounds;
  const bool wants_sort =
      (bounds.row_end - bounds.row_begin) * (bounds.column_end - bounds.column_begin) < kTileSize * kTileSize / 2;
  MarchRays::Met& met = wants_sort ? rays.unsorted : rays.met;
  int count = 0;
  rays.ended_count = 0;
  for (int row = bounds.row_begin; row < bounds.row_end; ++row)
    for (int column = bounds.column_begin / kStep * kStep; column < bounds.column_end; column += kStep) {
      const int first = row * kTileSize + column;
      Float enter = hn::Load(kFloat, rays.z_near + first), leave = constant(kNever);
      for (int axis = 0; axis < 3; ++axis) {
        const AxisRange range = clip_axis(rays, brick, axis, first);
        enter = hn::Max(enter, range.enter);
        leave = hn::Min(leave, range.leave);
      }
      const Float far = hn::Load(kFloat, rays.z_far + first);
      if (HWY_UNLIKELY(rays.has_intervals))
        note_ended(rays, first,
                   hn::And(hn::And(hn::Lt(far, leave), hn::Gt(far, constant(-kNever))), hn::Gt(leave, enter)));
      leave = hn::Min(leave, far);
      const Int columns = hn::Iota(kInt, column);
      const auto inside = hn::And(hn::Gt(columns, hn::Set(kInt, bounds.column_begin - 1)),
                                  hn::Lt(columns, hn::Set(kInt, bounds.column_end)));
      const Mask hit = hn::And(hn::Gt(leave, enter), hn::RebindMask(kFloat, inside));
      if (hn::AllFalse(kFloat, hit)) continue;
      const Int ray = hn::Iota(kInt, first);
      if (!wants_sort && hn::AllTrue(kFloat, hit)) {
        hn::StoreU(ray, kInt, met.ray + count);
        hn::StoreU(enter, kFloat, met.z_enter + count);
        hn::StoreU(leave, kFloat, met.z_leave + count);
        count += kStep;
        continue;
      }
      Float cells = constant(0.5f);
      for (int axis = 0; axis < 3; ++axis)
        cells = multiply_add(hn::Abs(hn::Load(kFloat, rays.direction[axis] + first)), cells_per_unit[axis], cells);
      const Int crossed = hn::ConvertTo(kInt, hn::Min(hn::Mul(cells, hn::Sub(leave, enter)), constant(1000.0f)));
      // Lane by lane: a compressing store of Highway 1.0.3 copies its table to the stack each time.
      HWY_ALIGN float z_enter[kLanes], z_leave[kLanes];
      HWY_ALIGN std::int32_t cells_crossed[kLanes];
      std::uint8_t bytes[8] = {};
      hn::Store(enter, kFloat, z_enter);
      hn::Store(leave, kFloat, z_leave);
      hn::Store(crossed, kInt, cells_crossed);
      hn::StoreMaskBits(kFloat, hit, bytes);
      for (unsigned lanes = bytes[0] | static_cast<unsigned>(bytes[1]) << 8; lanes != 0; lanes &= lanes - 1, ++count) {
        const int lane = std::countr_zero(lanes);
        met.ray[count] = first + lane;
        met.z_enter[count] = z_enter[lane];
        met.z_leave[count] = z_leave[lane];
        met.cells[count] = cells_crossed[lane];
      }
    }
  if (count == 0) return 0;
  if (wants_sort) sort_rays(rays, count);
  // The lanes beyond the last ray follow it.
  MarchRays::Met& sorted = rays.met;
  for (int i = 0; i < count; ++i) rays.has_met[sorted.ray[i]] = 1;
  for (int i = count; i % kStep != 0; ++i) {
    sorted.ray[i] = sorted.ray[count - 1];
    sorted.z_enter[i] = sorted.z_leave[i] = sorted.z_enter[count - 1];
  }
  return count;
}

/// What a vector of rays has gathered so far.
HWY_INLINE Accumulated load_accumulated(const MarchRays& rays, int first) {
  const Record sums = load_table_records(rays.sums, hn::BitCast(kUint, hn::LoadU(kInt, rays.met.ray + first)));
  return {sums.x, sums.y, sums.z, sums.w};
}

HWY_INLINE void store_accumulated(const Accumulated& sum, const MarchJob& job, int first, int count) {
  MarchRays& rays = *job.rays;
  HWY_ALIGN float sums[kLanes][4];
  hn::StoreInterleaved4(sum.red, sum.green, sum.blue, sum.transmittance, kFloat, sums[0]);
  const std::int32_t* ray = rays.met.ray + first;
  for (int i = 0; i < count; ++i) std::memcpy(rays.sums[ray[i]], sums[i], sizeof sums[i]);
  if (!job.use_early_ray_termination) return;
  const Mask settled = hn::Or(is_settled(sum), hn::Lt(sum.transmittance, constant(job.negligible)));
  if (HWY_LIKELY(hn::AllFalse(kFloat, settled))) return;
  HWY_ALIGN std::int32_t ended[kLanes];
  hn::Store(hn::IfThenElseZero(int_mask(settled), hn::Set(kInt, 1)), kInt, ended);
  for (int i = 0; i < count; ++i)
    if (ended[i]) rays.z_far[ray[i]] = -kNever;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
