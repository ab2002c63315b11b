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
#include "src/cpu/kernels/shading-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The derivative of a trilinear cell along the lattice's axes, at `t` in it.
HWY_INLINE Triple find_slope(const Record& low, const Record& high, const Float t[3]) {
  const auto along_x = [&](const Record& r) { return mix(t[1], hn::Sub(r.y, r.x), hn::Sub(r.w, r.z)); };
  const auto along_y = [&](const Record& r) { return hn::Sub(mix(t[0], r.z, r.w), mix(t[0], r.x, r.y)); };
  return {mix(t[2], along_x(low), along_x(high)), mix(t[2], along_y(low), along_y(high)),
          hn::Sub(mix_square(high, t[0], t[1]), mix_square(low, t[0], t[1]))};
}

/// Gradients at the corners of a cell (MarchBrick::gradients), trilinear in between: `node` is its lower corner, `row`
/// and `slice` nodes lie in a row and in a slice.
HWY_INLINE Triple mix_gradients(const float* gradients, Uint node, std::int32_t row, std::int32_t slice,
                                const Float t[3]) {
  const auto load = [&](std::int32_t offset) {
    const Record r = load_table_records(gradients, hn::Add(node, hn::Set(kUint, static_cast<std::uint32_t>(offset))));
    return Triple{r.x, r.y, r.z};
  };
  const auto edge = [&](std::int32_t offset) { return mix(t[0], load(offset), load(offset + 1)); };
  const auto square = [&](std::int32_t offset) { return mix(t[1], edge(offset), edge(offset + row)); };
  return mix(t[2], square(0), square(slice));
}

/// The trilinear field of an even brick anywhere inside it.
class LatticeSampler {
 public:
  explicit LatticeSampler(const MarchBrick& brick)
      : records_(brick.records), slice_(4 * static_cast<std::ptrdiff_t>(brick.cells[0]) * brick.cells[1]) {
    for (int axis = 0; axis < 3; ++axis) last_cell_[axis] = static_cast<float>(brick.cells[axis] - 1);
    row_ = static_cast<float>(brick.cells[0]);
    rows_ = static_cast<float>(brick.cells[1]);
    layer_ = row_ * rows_;
  }

  /// `at`: lattice coordinates. A hair beyond the brick the field goes on as in its last cells.
  HWY_INLINE Float eval(const Float at[3]) const {
    Float cell[3], t[3];
    find_cell(at, cell, t);
    const Uint record = number_of(cell, row_, layer_);
    const Record low = load_table_records(records_, record), high = load_table_records(records_ + slice_, record);
    return mix(t[2], mix_square(low, t[0], t[1]), mix_square(high, t[0], t[1]));
  }

  /// The derivative of the field along the lattice's axes.
  HWY_INLINE Triple eval_slope(const Float at[3]) const {
    Float cell[3], t[3];
    find_cell(at, cell, t);
    const Uint record = number_of(cell, row_, layer_);
    return find_slope(load_table_records(records_, record), load_table_records(records_ + slice_, record), t);
  }

  /// Gradients at the nodes (MarchBrick::gradients), trilinear in between.
  HWY_INLINE Triple eval_gradient(const float* gradients, const Float at[3]) const {
    Float cell[3], t[3];
    find_cell(at, cell, t);
    const float row = row_ + 1.0f, layer = row * (rows_ + 1.0f);
    const Uint node = number_of(cell, row, layer);
    return mix_gradients(gradients, node, static_cast<std::int32_t>(row), static_cast<std::int32_t>(layer), t);
  }

 private:
  HWY_INLINE void find_cell(const Float at[3], Float cell[3], Float t[3]) const {
    for (int axis = 0; axis < 3; ++axis) {
      const Float inside = hn::Min(hn::Max(at[axis], constant(0.0f)), constant(last_cell_[axis]));
      cell[axis] = hn::Floor(inside);
      t[axis] = hn::Sub(at[axis], cell[axis]);
    }
  }
  static HWY_INLINE Uint number_of(const Float cell[3], float row, float layer) {
    const Float index = multiply_add(cell[2], constant(layer), multiply_add(cell[1], constant(row), cell[0]));
    return hn::BitCast(kUint, round_small(index));
  }

  const float* records_;
  std::ptrdiff_t slice_;
  float last_cell_[3], row_, rows_, layer_;  // cells in a row, rows in a layer, cells in a layer
};

/// Where a vector of rays starts in a brick, and its steps.
struct StridePlan {
  Float at[3], step[3];  ///< lattice coordinates
  Float steps, length;   ///< how many, and the world length of one

  HWY_INLINE StridePlan(const MarchJob& job, int first) {
    const MarchBrick& brick = *job.brick;
    const MarchRays::Met& met = job.rays->met;
    const Course course(*job.rays, first);
    const Float enter = hn::LoadU(kFloat, met.z_enter + first);
    const Float depth = hn::Sub(hn::LoadU(kFloat, met.z_leave + first), enter);
    Float square = constant(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      const Float cells = constant(static_cast<float>(brick.cells[axis]) / (brick.upper[axis] - brick.lower[axis]));
      const Float offset = hn::Sub(course.origin[axis], constant(brick.lower[axis]));
      at[axis] = hn::Mul(multiply_add(course.direction[axis], enter, offset), cells);
      step[axis] = hn::Mul(hn::Mul(course.direction[axis], depth), cells);
      square = multiply_add(step[axis], step[axis], square);
    }
    const Float world = hn::Mul(depth, course.world_per_z);
    const Float wanted = hn::Ceil(job.sample_distance > 0.0f ? hn::Mul(world, constant(1.0f / job.sample_distance))
                                                             : hn::Mul(hn::Sqrt(square), constant(1.0f / job.stride)));
    steps = hn::Min(hn::Max(wanted, constant(1.0f)), constant(1e5f));
    const Float share = hn::Div(constant(1.0f), steps);
    for (Float& along : step) along = hn::Mul(along, share);
    length = hn::Mul(world, share);
  }
};

/// Takes the rays through the brick in equal steps, the first sample where they enter, the last where they leave.
///
/// Two vectors of rays travel side by side: while one waits for what it loads, the other has something to do.
template <class Integrator>
class Strider {
 public:
  explicit Strider(const MarchJob& job) : job_(job), sampler_(*job.brick), integrator_(*job.tables) {}

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
    const StridePlan plan(job_, first);
    for (int axis = 0; axis < 3; ++axis) {
      rays.at[axis] = plan.at[axis];
      rays.step[axis] = plan.step[axis];
    }
    rays.steps = plan.steps;
    rays.length = plan.length;
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
  std::uint64_t segments_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
