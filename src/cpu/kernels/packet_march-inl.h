// The source `march` at a fixed rate: packets of rays go through the whole grid in equal steps, side by side, and read
// the values where they lie.

#if defined(TETRAVOX_CPU_PACKET_MARCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_PACKET_MARCH_INL
#undef TETRAVOX_CPU_PACKET_MARCH_INL
#else
#define TETRAVOX_CPU_PACKET_MARCH_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/lattice-inl.h"
#include "src/cpu/kernels/packet_light-inl.h"
#include "src/cpu/kernels/rays-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/value_sampler-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"
#include "tetravox/grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Takes the rays of a tile through the whole grid.
///
/// All rays of a packet take the same numbers of samples, counted from depth 0 of the camera's frame: depth = number *
/// distance, cut to where the ray lies in the grid. Of each run of `kRun` steps the packet asks once whether any brick
/// on its way is seen.
template <class T, class Integrator, bool kIsLit>
class PacketMarcher {
 public:
  explicit PacketMarcher(const PacketJob& job)
      : job_(job), sampler_(*job.values), integrator_(*job.tables), lit_steps_(job, integrator_, sampler_) {}

  std::uint64_t run() {
    for (int row = 0; row < kTileSize; row += kRows)
      for (int column = 0; column < kTileSize; column += kColumns) march(column, row);
    return segments_;
  }

 private:
  static constexpr int kColumns = 4, kRows = 4, kRays = kColumns * kRows, kRun = 6;
  static constexpr bool kRoundsScalars = std::is_integral_v<T> && requires { requires Integrator::kRoundsScalars; };
  static constexpr int kVectors = kRays / static_cast<int>(kLanes);

  struct Rays {
    HWY_ALIGN std::int32_t index[kLanes];
    RayCourse course;
    Float world_per_z;
    Float distance;      // depth from sample to sample
    Float enter, leave;  // depths between which the ray is drawn
    Float depth;         // so far
    Float at[3];         // there
    Float scalar;
    typename Integrator::Front front;
    Accumulated sum;
    Int taken;  // steps
    Mask settled;

    HWY_INLINE Float depth_at(float number) const {
      return hn::Min(hn::Max(hn::Mul(constant(number), distance), enter), leave);
    }
    HWY_INLINE void place(Float z, Float to[3]) const {
      for (int axis = 0; axis < 3; ++axis) to[axis] = multiply_add(course.direction[axis], z, course.origin[axis]);
    }
  };

  struct Unlit {
    Unlit(const PacketJob&, const Integrator&, const ValueSampler<T>&) {}
  };

  static HWY_INLINE float smallest(Float values) { return hn::GetLane(hn::MinOfLanes(kFloat, values)); }

  /// Where a run of steps leads a packet, and the cells between whose corners all of its rays stay.
  struct Run {
    Float depth[kVectors], at[kVectors][3];
    bool is_any = true;  // whether any ray moves
    std::ptrdiff_t low[3], high[3];

    HWY_INLINE Run(const PacketMarcher& marcher, const Rays packet[kVectors], float last_number) {
      const Float never = constant(kNever);
      Float least[3] = {never, never, never}, most[3] = {hn::Neg(never), hn::Neg(never), hn::Neg(never)};
      for (int i = 0; i < kVectors; ++i) {
        depth[i] = packet[i].depth_at(last_number);
        packet[i].place(depth[i], at[i]);
        const Mask moves = hn::Gt(depth[i], packet[i].depth);
        for (int axis = 0; axis < 3; ++axis) {
          const Float a = packet[i].at[axis], b = at[i][axis];
          least[axis] = hn::Min(least[axis], hn::IfThenElse(moves, hn::Min(a, b), never));
          most[axis] = hn::Max(most[axis], hn::IfThenElse(moves, hn::Max(a, b), hn::Neg(never)));
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        const float from = smallest(least[axis]), to = -smallest(hn::Neg(most[axis]));
        is_any &= from <= to;
        const auto last = static_cast<float>(marcher.job_.values->dimensions[axis] - 1);
        low[axis] = static_cast<std::ptrdiff_t>(std::clamp(from, 0.0f, last));
        high[axis] = static_cast<std::ptrdiff_t>(std::clamp(to, 0.0f, last));
      }
    }

    HWY_INLINE void skip(Rays packet[kVectors]) const {
      for (int i = 0; i < kVectors; ++i) {
        packet[i].depth = depth[i];
        for (int axis = 0; axis < 3; ++axis) packet[i].at[axis] = at[i][axis];
      }
    }
  };

  HWY_INLINE void set_out(int column, int row, int vector, Rays& rays) const {
    const MarchRays& tile = *job_.rays;
    for (int lane = 0; lane < static_cast<int>(kLanes); ++lane) {
      const int ray = vector * static_cast<int>(kLanes) + lane;
      rays.index[lane] = (row + ray / kColumns) * kTileSize + column + ray % kColumns;
    }
    const Int index = hn::Load(kInt, rays.index);
    if constexpr (kIsLit) {
      rays.course.view = view_of(*job_.grid, pixels_of_tile(*job_.grid, job_.column, job_.row, index));
      const Triple direction = rays.course.view.direction();
      rays.course.per_square = hn::Div(constant(1.0f), dot(direction, direction));
    }
    const auto gather = [&](const float* from) { return hn::GatherIndex(kFloat, from, index); };
    const Float never = constant(kNever);
    rays.enter = gather(tile.z_near);
    rays.leave = gather(tile.z_far);
    for (int axis = 0; axis < 3; ++axis) {
      const Float origin = gather(tile.origin[axis]), direction = gather(tile.direction[axis]);
      const Float lower = constant(0.0f), upper = constant(static_cast<float>(job_.values->dimensions[axis] - 1));
      const Mask is_inside = hn::And(hn::Ge(origin, lower), hn::Le(origin, upper));
      const AxisRange range =
          heed_parallel(range_between(lower, upper, origin, gather(tile.inverse[axis])), direction, is_inside);
      rays.enter = hn::Max(rays.enter, range.enter);
      rays.leave = hn::Min(rays.leave, range.leave);
      rays.course.origin[axis] = origin;
      rays.course.direction[axis] = direction;
    }
    rays.world_per_z = load_table_records(tile.start, hn::BitCast(kUint, index)).w;
    rays.distance = hn::Div(constant(job_.sample_distance), hn::Max(rays.world_per_z, constant(1e-30f)));
    const Mask misses = hn::Not(hn::Lt(rays.enter, rays.leave));
    rays.enter = hn::IfThenElse(misses, never, rays.enter);
    rays.leave = hn::IfThenElse(misses, hn::Neg(never), rays.leave);
    const Record sums = load_table_records(tile.sums, hn::BitCast(kUint, index));
    rays.sum = {sums.x, sums.y, sums.z, sums.w};
    rays.taken = hn::Zero(kInt);
    rays.settled = hn::FirstN(kFloat, 0);
  }

  void march(int column, int row) {
    Rays packet[kVectors];
    Float first = constant(kNever), last = constant(-kNever);
    for (int i = 0; i < kVectors; ++i) {
      set_out(column, row, i, packet[i]);
      first = hn::Min(first, hn::Div(packet[i].enter, packet[i].distance));
      last = hn::Max(last, hn::Div(packet[i].leave, packet[i].distance));
    }
    const float begin = std::floor(smallest(first)), end = -smallest(hn::Neg(last));
    for (Rays& rays : packet) {
      // Rays that miss the grid stay where nothing happens.
      const Mask misses = hn::Gt(rays.enter, rays.leave);
      rays.enter = hn::IfThenElseZero(hn::Not(misses), rays.enter);
      rays.leave = hn::IfThenElseZero(hn::Not(misses), rays.leave);
      rays.depth = rays.depth_at(begin);
      rays.place(rays.depth, rays.at);
    }
    bool is_ready = false;  // whether the scalars at hand are those of the last sample
    for (float number = begin; number < end; number += static_cast<float>(kRun)) {
      const Run run(*this, packet, number + static_cast<float>(kRun));
      if (!run.is_any || !touches_seen(run)) {
        run.skip(packet);
        is_ready = false;
        continue;
      }
      if (job_.is_large) prefetch(run, packet[0].at);
      bool goes_on = false;
      for (Rays& rays : packet)
        goes_on |= is_whole(rays, number) ? take_steps<true>(rays, number, is_ready)
                                          : take_steps<false>(rays, number, is_ready);
      if (!goes_on) break;
      is_ready = true;
    }
    for (const Rays& rays : packet) arrive(rays);
  }

  /// Whether any brick of those that the run may touch is seen.
  HWY_INLINE bool touches_seen(const Run& run) const {
    std::ptrdiff_t first[3], last[3], brick = 0, stride = 1;
    unsigned span = 0;
    bool is_wide = false;
    for (int axis = 0; axis < 3; ++axis) {
      const std::ptrdiff_t end = job_.brick_counts[axis] - 1;
      first[axis] = std::min(run.low[axis] / kBrickCells, end);
      last[axis] = std::min(run.high[axis] / kBrickCells, end);
      is_wide |= last[axis] - first[axis] > 1;
      span |= static_cast<unsigned>(last[axis] - first[axis]) << axis;
      brick += first[axis] * stride;
      stride *= job_.brick_counts[axis];
    }
    if (HWY_UNLIKELY(is_wide)) return any_is_seen(first, last);
    return (job_.seen_spans[brick] >> span & 1u) != 0;
  }
  /// Of many: rays far apart, or long steps.
  HWY_NOINLINE bool any_is_seen(const std::ptrdiff_t first[3], const std::ptrdiff_t last[3]) const {
    for (std::ptrdiff_t k = first[2]; k <= last[2]; ++k)
      for (std::ptrdiff_t j = first[1]; j <= last[1]; ++j)
        for (std::ptrdiff_t i = first[0]; i <= last[0]; ++i)
          if (job_.seen_spans[(k * job_.brick_counts[1] + j) * job_.brick_counts[0] + i] & 1u) return true;
    return false;
  }

  /// Asks for the values of the next run, whose box is taken to be as far from this one as this one is long.
  HWY_INLINE void prefetch(const Run& run, const Float from[3]) const {
    const MarchValues& v = *job_.values;
    std::ptrdiff_t begin[3], end[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto shift = static_cast<std::ptrdiff_t>(hn::GetLane(hn::Sub(run.at[0][axis], from[axis])));
      const std::ptrdiff_t last = v.dimensions[axis] - 1;
      begin[axis] = std::clamp(run.low[axis] + shift, std::ptrdiff_t{0}, last);
      end[axis] = std::clamp(run.high[axis] + shift + 1, std::ptrdiff_t{0}, last);
    }
    constexpr std::ptrdiff_t kMostRows = 16 * kRays;  // more are farther apart than the rays can use
    if ((end[1] - begin[1]) * (end[2] - begin[2]) > kMostRows) return;
    for (std::ptrdiff_t k = begin[2]; k <= end[2]; ++k)
      for (std::ptrdiff_t j = begin[1]; j <= end[1]; ++j)
        __builtin_prefetch(v.values + k * v.slice_bytes + j * v.row_bytes + begin[0] * v.value_bytes);
  }

  HWY_INLINE Float sample(const Float at[3]) const {
    if constexpr (kRoundsScalars)
      return sampler_.eval_rounded(at);
    else
      return sampler_.eval(at);
  }

  /// Whether no ray begins or ends in the run.
  static HWY_INLINE bool is_whole(const Rays& rays, float number) {
    const Float first = hn::Mul(constant(number), rays.distance);
    const Float last = hn::Mul(constant(number + static_cast<float>(kRun)), rays.distance);
    return hn::AllTrue(kFloat, hn::And(hn::Ge(first, rays.enter), hn::Le(last, rays.leave)));
  }

  /// Takes a vector of rays on by `kRun` samples; returns whether any goes on.
  template <bool kIsWhole>
  HWY_INLINE bool take_steps(Rays& rays, float number, bool is_ready) {
    if (!is_ready) {
      rays.scalar = sample(rays.at);
      rays.front = integrator_.front_at(rays.scalar);
    }
    Float depth = rays.depth, scalar = rays.scalar;
    Accumulated sum = rays.sum;
    if constexpr (kIsLit) lit_steps_.begin_run();
    // Samples do not wait for each other: all of them first.
    HWY_ALIGN float backs[kRun * kLanes];
    const auto depth_after = [&](int step) {
      const float next = number + static_cast<float>(step + 1);
      return kIsWhole ? hn::Mul(constant(next), rays.distance) : rays.depth_at(next);
    };
    for (int step = 0; step < kRun; ++step) {
      Float at[3];
      rays.place(depth_after(step), at);
      hn::Store(sample(at), kFloat, backs + step * kLanes);
    }
    for (int step = 0; step < kRun; ++step) {
      const Float next = depth_after(step), back = hn::Load(kFloat, backs + step * kLanes);
      const Float moved = hn::Sub(next, depth);
      if constexpr (!kIsWhole) {
        const Mask moves = hn::Gt(moved, constant(0.0f));
        rays.taken = hn::Add(rays.taken, hn::IfThenElseZero(int_mask(moves), hn::Set(kInt, 1)));
      }
      const Segments segment{scalar, back, hn::Mul(moved, rays.world_per_z)};
      if constexpr (kIsLit) {
        const Float zero = constant(0.0f), before = sum.transmittance;
        Accumulated part{zero, zero, zero, before};
        integrate<kIsWhole>(segment, rays.front, part);
        lit_steps_.add(segment, depth, next, part, before);
        sum.transmittance = part.transmittance;
      } else {
        integrate<kIsWhole>(segment, rays.front, sum);
      }
      scalar = back;
      depth = next;
    }
    if constexpr (kIsLit) lit_steps_.composite(rays.course, sum);
    if constexpr (kIsWhole) rays.taken = hn::Add(rays.taken, hn::Set(kInt, kRun));
    rays.scalar = scalar;
    rays.depth = depth;
    rays.place(depth, rays.at);
    rays.sum = sum;
    Mask ended = hn::Ge(depth, rays.leave);
    if (job_.use_early_ray_termination) {
      const Mask settled = hn::Or(is_settled(sum), hn::Lt(sum.transmittance, constant(job_.negligible)));
      rays.leave = hn::IfThenElse(settled, depth, rays.leave);
      rays.settled = hn::Or(rays.settled, settled);
      ended = hn::Or(ended, settled);
    }
    return !hn::AllTrue(kFloat, ended);
  }

  template <bool kIsWhole>
  HWY_INLINE void integrate(const Segments& segment, typename Integrator::Front& front, Accumulated& sum) const {
    if constexpr (kIsWhole && requires { integrator_.add_whole(segment.scalar_back, front, sum); })
      integrator_.add_whole(segment.scalar_back, front, sum);
    else
      integrator_.integrate(segment, front, sum);
  }

  void arrive(const Rays& rays) {
    HWY_ALIGN float sums[kLanes][4];
    HWY_ALIGN std::int32_t taken[kLanes], settled[kLanes];
    hn::StoreInterleaved4(rays.sum.red, rays.sum.green, rays.sum.blue, rays.sum.transmittance, kFloat, sums[0]);
    hn::Store(rays.taken, kInt, taken);
    hn::Store(hn::IfThenElseZero(int_mask(rays.settled), hn::Set(kInt, 1)), kInt, settled);
    for (std::size_t i = 0; i < kLanes; ++i) {
      std::memcpy(job_.rays->sums[rays.index[i]], sums[i], sizeof sums[i]);
      segments_ += static_cast<std::uint64_t>(taken[i]);
      if (taken[i] > 0) job_.rays->has_met[rays.index[i]] = 1;
      if (settled[i]) job_.rays->z_far[rays.index[i]] = -kNever;
    }
  }

  const PacketJob& job_;
  ValueSampler<T> sampler_;
  Integrator integrator_;
  std::conditional_t<kIsLit, LitSteps<T, Integrator, kRun>, Unlit> lit_steps_;
  std::uint64_t segments_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
