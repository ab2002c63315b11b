// The source `march` where a grid is smooth enough: equal steps through a brick, whatever cells lie between.

#if defined(TETRAVOX_CPU_STRIDE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_STRIDE_INL
#undef TETRAVOX_CPU_STRIDE_INL
#else
#define TETRAVOX_CPU_STRIDE_INL
#endif

#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/lattice-inl.h"
#include "src/cpu/kernels/rays-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The trilinear field of an even brick anywhere inside it.
class LatticeSampler {
 public:
  explicit LatticeSampler(const MarchBrick& brick)
      : records_(brick.records), slice_(4 * static_cast<std::ptrdiff_t>(brick.cells[0]) * brick.cells[1]) {
    for (int axis = 0; axis < 3; ++axis) last_cell_[axis] = static_cast<float>(brick.cells[axis] - 1);
    row_ = static_cast<float>(brick.cells[0]);
    layer_ = row_ * static_cast<float>(brick.cells[1]);
  }

  /// `at`: lattice coordinates. A hair beyond the brick the field goes on as in its last cells.
  HWY_INLINE Float eval(const Float at[3]) const {
    Float cell[3], t[3];
    for (int axis = 0; axis < 3; ++axis) {
      const Float inside = hn::Min(hn::Max(at[axis], constant(0.0f)), constant(last_cell_[axis]));
      cell[axis] = hn::ConvertTo(kFloat, hn::ConvertTo(kInt, inside));
      t[axis] = hn::Sub(at[axis], cell[axis]);
    }
    const Float index = multiply_add(cell[2], constant(layer_), multiply_add(cell[1], constant(row_), cell[0]));
    const Uint record = hn::BitCast(kUint, hn::ConvertTo(kInt, index));
    const Record low = load_table_records(records_, record), high = load_table_records(records_ + slice_, record);
    const auto mix = [](Float f, Float a, Float b) { return multiply_add(f, hn::Sub(b, a), a); };
    const auto mix_square = [&](const Record& r) { return mix(t[1], mix(t[0], r.x, r.y), mix(t[0], r.z, r.w)); };
    return mix(t[2], mix_square(low), mix_square(high));
  }

 private:
  const float* records_;
  std::ptrdiff_t slice_;
  float last_cell_[3], row_, layer_;
};

/// Takes the rays through the brick in equal steps, the first sample where they enter, the last where they leave.
///
/// Two vectors of rays travel side by side: while one waits for what it loads, the other has something to do.
template <class Integrator>
class Strider {
 public:
  explicit Strider(const MarchJob& job)
      : job_(job), sampler_(*job.brick), integrator_(*job.tables), steps_per_cell_(constant(1.0f / job.stride)) {
    const MarchBrick& brick = *job.brick;
    for (int axis = 0; axis < 3; ++axis)
      cells_per_unit_[axis] = constant(static_cast<float>(brick.cells[axis]) / (brick.upper[axis] - brick.lower[axis]));
  }

  std::uint64_t run(int count) {
    constexpr int kStep = static_cast<int>(kLanes);
    for (int first = 0; first < count; first += 2 * kStep) {
      // An odd vector has a companion of the same rays that does nothing.
      const int more = std::max(std::min(count - first - kStep, kStep), 0);
      Travellers pair[2];
      set_out(first, std::min(count - first, kStep), pair[0]);
      set_out(more > 0 ? first + kStep : first, more, pair[1]);
      travel(pair);
      arrive(pair[0], first, std::min(count - first, kStep));
      arrive(pair[1], first + kStep, more);
    }
    return segments_;
  }

 private:
  struct Travellers {
    Float at[3], step[3];  // lattice coordinates
    Float steps, length;   // how many, and the world length of one
    Float scalar;
    typename Integrator::Front front;
    Accumulated sum;
    Mask alive;
  };

  HWY_INLINE void set_out(int first, int lanes, Travellers& rays) const {
    const MarchRays::Met& met = job_.rays->met;
    const Course course(*job_.rays, first);
    const Float enter = hn::LoadU(kFloat, met.z_enter + first);
    const Float depth = hn::Sub(hn::LoadU(kFloat, met.z_leave + first), enter);
    Float square = constant(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      const Float offset = hn::Sub(course.origin[axis], constant(job_.brick->lower[axis]));
      rays.at[axis] = hn::Mul(multiply_add(course.direction[axis], enter, offset), cells_per_unit_[axis]);
      rays.step[axis] = hn::Mul(hn::Mul(course.direction[axis], depth), cells_per_unit_[axis]);
      square = multiply_add(rays.step[axis], rays.step[axis], square);
    }
    const Float world = hn::Mul(depth, course.world_per_z);
    const Float wanted = hn::Ceil(job_.sample_distance > 0.0f ? hn::Mul(world, constant(1.0f / job_.sample_distance))
                                                              : hn::Mul(hn::Sqrt(square), steps_per_cell_));
    rays.steps = hn::Min(hn::Max(wanted, constant(1.0f)), constant(1e5f));
    const Float share = hn::Div(constant(1.0f), rays.steps);
    for (Float& along : rays.step) along = hn::Mul(along, share);
    rays.length = hn::Mul(world, share);
    rays.scalar = sampler_.eval(rays.at);
    rays.front = integrator_.front_at(rays.scalar);
    rays.sum = load_accumulated(*job_.rays, first);
    rays.alive = hn::FirstN(kFloat, static_cast<std::size_t>(lanes));
  }

  void travel(Travellers pair[2]) {
    Float number = constant(1.0f);
    do {
      Segments segments[2];
#pragma GCC unroll 2
      for (int k = 0; k < 2; ++k) {
        Travellers& rays = pair[k];
        segments_ += hn::CountTrue(kFloat, rays.alive);
        for (int axis = 0; axis < 3; ++axis) rays.at[axis] = hn::Add(rays.at[axis], rays.step[axis]);
        segments[k] = {rays.scalar, sampler_.eval(rays.at), hn::IfThenElseZero(rays.alive, rays.length)};
        rays.scalar = segments[k].scalar_back;
      }
#pragma GCC unroll 2
      for (int k = 0; k < 2; ++k) {
        integrator_.integrate(segments[k], pair[k].front, pair[k].sum);
        pair[k].alive = hn::And(pair[k].alive, hn::Lt(number, pair[k].steps));
      }
      number = hn::Add(number, constant(1.0f));
    } while (!hn::AllFalse(kFloat, hn::Or(pair[0].alive, pair[1].alive)));
  }

  void arrive(const Travellers& rays, int first, int lanes) const {
    if (lanes > 0) store_accumulated(rays.sum, job_, first, lanes);
  }

  const MarchJob& job_;
  LatticeSampler sampler_;
  Integrator integrator_;
  Float steps_per_cell_, cells_per_unit_[3];
  std::uint64_t segments_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
