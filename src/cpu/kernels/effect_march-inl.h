// The source `march` with effects: rays go from cell to cell of a brick, cut at surfaces and lit.

#if defined(TETRAVOX_CPU_EFFECT_MARCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_EFFECT_MARCH_INL
#undef TETRAVOX_CPU_EFFECT_MARCH_INL
#else
#define TETRAVOX_CPU_EFFECT_MARCH_INL
#endif

#include "src/cpu/kernels/effects-inl.h"
#include "src/cpu/kernels/march-inl.h"
#include "src/cpu/kernels/stride-inl.h"

#include <algorithm>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// What a vector of rays passes in trilinear cells (see stretches-inl.h): a cubic of the scalar.
struct CellStretch {
  static constexpr bool kIsLinear = false, kHasLinearGradient = false;

  Float scalar_front, scalar_back, z_front, z_back, length;
  const MarchJob& job;
  const LatticeRays& rays;
  const CellCorners& corners;
  const CellCubic& cubic;
  const CellCubic* others;  ///< [kMostVariables] of the function's axes that have one

  HWY_INLINE Float scalar(Float u) const { return cubic.eval(u); }
  HWY_INLINE Float other(int axis, Float u) const { return others[axis].eval(u); }
  HWY_INLINE Float other_bend(int axis) const { return others[axis].bend(); }
  HWY_INLINE Float bend() const { return cubic.bend(); }
  HWY_INLINE Float slope(Float u) const {
    const Float two_c2 = hn::Add(cubic.c2, cubic.c2), three_c3 = hn::Mul(constant(3.0f), cubic.c3);
    return multiply_add(u, multiply_add(u, three_c3, two_c2), cubic.c1);
  }

  /// Where the cubic turns, ascending; 2 where it does not.
  HWY_INLINE void find_extrema(Float extrema[2]) const {
    const Float never = constant(2.0f), zero = constant(0.0f);
    const Float three_c3 = hn::Mul(constant(3.0f), cubic.c3);
    const Float discriminant = hn::Sub(hn::Mul(cubic.c2, cubic.c2), hn::Mul(three_c3, cubic.c1));
    const Mask turns = hn::Gt(discriminant, zero);
    const Float root = hn::Sqrt(hn::Max(discriminant, zero));
    const Float q = hn::Neg(hn::Add(cubic.c2, hn::CopySign(root, cubic.c2)));
    const auto ratio = [&](Float above, Float below) {
      const Mask valid = hn::And(turns, hn::Gt(hn::Abs(below), constant(1e-20f)));
      return hn::IfThenElse(valid, hn::Div(above, hn::IfThenElse(valid, below, constant(1.0f))), never);
    };
    const Float a = ratio(q, three_c3), b = ratio(cubic.c1, q);
    extrema[0] = hn::Min(a, b);
    extrema[1] = hn::Max(a, b);
  }

  HWY_INLINE Float count_pieces(const Cut& begin, const Cut& end, Float transmittance) const {
    const Float one = constant(1.0f);
    const Float bend = hn::Mul(transmittance, cubic.bend());
    const Mask bent = hn::Gt(hn::Mul(bend, constant(job.brick->steepness)), constant(job.allowed_rate));
    if (HWY_LIKELY(hn::AllFalse(kFloat, hn::And(bent, hn::Gt(length, constant(0.0f)))))) return one;
    const Float margin = hn::Mul(constant(1.5f), cubic.bend());
    const Float low = hn::Sub(hn::Min(begin.scalar, end.scalar), margin);
    const Float high = hn::Add(hn::Max(begin.scalar, end.scalar), margin);
    const Float rate = hn::IfThenElseZero(bent, hn::Mul(bend, find_steepness(*job.steepness, low, high)));
    const Float root = hn::Sqrt(hn::Mul(rate, constant(1.0f / job.allowed_rate)));
    const Float wanted = hn::Ceil(hn::Mul(root, hn::Sub(end.u, begin.u)));
    return hn::Min(hn::Max(wanted, one), constant(job.most_pieces));
  }

  HWY_INLINE Triple gradient(Float u) const {
    Float t[3];
    find_place(u, t);
    if (job.brick->gradients) return interpolate_gradients(t);
    const Triple slope = find_slope(corners.low, corners.high, t);
    Float size[3];
    rays.find_cell_size(size);
    return {hn::Div(slope.x, size[0]), hn::Div(slope.y, size[1]), hn::Div(slope.z, size[2])};
  }

 private:
  HWY_INLINE void find_place(Float u, Float t[3]) const {
    const Float depth = multiply_add(u, hn::Sub(z_back, z_front), z_front);
    for (int axis = 0; axis < 3; ++axis) t[axis] = rays.place(axis, depth);
  }

  /// Of the gradients at the corners.
  HWY_NOINLINE Triple interpolate_gradients(const Float t[3]) const {
    const MarchBrick& brick = *job.brick;
    // From the number of a cell to that of its lower corner: rows and slices have one node more.
    const float slice_cells = static_cast<float>(brick.cells[0]) * static_cast<float>(brick.cells[1]);
    const auto quotient = [](Float a, float b) {
      return hn::Floor(hn::Mul(hn::Add(a, constant(0.5f)), constant(1.0f / b)));
    };
    const Float cell = hn::ConvertTo(kFloat, rays.cell);
    const Float slice = quotient(cell, slice_cells);
    const Float in_slice = hn::Sub(cell, hn::Mul(slice, constant(slice_cells)));
    const Float row = quotient(in_slice, static_cast<float>(brick.cells[0]));
    const std::int32_t row_nodes = brick.cells[0] + 1, slice_nodes = row_nodes * (brick.cells[1] + 1);
    const Float more = multiply_add(slice, constant(static_cast<float>(slice_nodes) - slice_cells), row);
    const Uint node = hn::BitCast(kUint, hn::Add(rays.cell, hn::ConvertTo(kInt, more)));
    return mix_gradients(brick.gradients, node, row_nodes, slice_nodes, t);
  }
};

/// What a vector of rays passes in one of equal steps through a brick, on which the scalar counts as linear.
struct StepStretch {
  static constexpr bool kIsLinear = true, kHasLinearGradient = false;

  Float scalar_front, scalar_back, z_front, z_back, length;
  const LatticeSampler& sampler;
  const Float* at;    ///< lattice coordinates of its end
  const Float* step;  ///< from its beginning to its end
  const MarchBrick& brick;

  HWY_INLINE Float scalar(Float u) const { return multiply_add(u, hn::Sub(scalar_back, scalar_front), scalar_front); }

  HWY_NOINLINE Triple gradient(Float u) const {
    Float place[3];
    find_place(u, place);
    if (brick.gradients) return sampler.eval_gradient(brick.gradients, place);
    const Triple slope = sampler.eval_slope(place);
    return {hn::Mul(slope.x, constant(cells_per_unit(0))), hn::Mul(slope.y, constant(cells_per_unit(1))),
            hn::Mul(slope.z, constant(cells_per_unit(2)))};
  }

 private:
  HWY_INLINE float cells_per_unit(int axis) const {
    return static_cast<float>(brick.cells[axis]) / (brick.upper[axis] - brick.lower[axis]);
  }
  HWY_INLINE void find_place(Float u, Float place[3]) const {
    const Float back = hn::Sub(u, constant(1.0f));
    for (int axis = 0; axis < 3; ++axis) place[axis] = multiply_add(back, step[axis], at[axis]);
  }
};

/// What a vector of rays passes in constant cells.
struct ConstantStretch {
  static constexpr bool kIsLinear = true, kHasLinearGradient = true;

  Float scalar_front, scalar_back, z_front, z_back, length;
  const MarchBrick& brick;
  Int cell;

  HWY_INLINE Float scalar(Float) const { return scalar_front; }
  HWY_INLINE Float other(int axis, Float) const { return hn::GatherIndex(kFloat, brick.others[axis], cell); }
  HWY_INLINE void end_gradients(Triple ends[2]) const { ends[0] = ends[1] = gradient(constant(0.0f)); }
  HWY_INLINE Triple gradient(Float) const {
    if (!brick.gradients) return {constant(0.0f), constant(0.0f), constant(0.0f)};
    const Record r = load_table_records(brick.gradients, hn::BitCast(kUint, cell));
    return {r.x, r.y, r.z};
  }
};

/// Where a vector of rays lies in the picture, and what it has met so far.
struct PassingRays {
  HWY_ALIGN std::int32_t pixels[kLanes];
  RayView view;
  Float depth;
  Float z_left, scalar_left;

  PassingRays(const MarchJob& job, int first) {
    const scene::RayGrid& grid = *job.grid;
    const Int ray = hn::LoadU(kInt, job.rays->met.ray + first);
    const RayPixels at = pixels_of_tile(grid, job.column, job.row, ray);
    hn::Store(hn::Add(hn::Mul(at.row, hn::Set(kInt, grid.width)), at.column), kInt, pixels);
    view = view_of(grid, at);
    view.pixels = pixels;
    depth = hn::GatherIndex(kFloat, job.rays->depth, ray);
    z_left = hn::GatherIndex(kFloat, job.rays->z_left, ray);
    scalar_left = hn::GatherIndex(kFloat, job.rays->scalar_left, ray);
  }

  void store(const MarchJob& job, int first, int count) const {
    HWY_ALIGN float values[3][kLanes];
    hn::Store(depth, kFloat, values[0]);
    hn::Store(z_left, kFloat, values[1]);
    hn::Store(scalar_left, kFloat, values[2]);
    for (int i = 0; i < count; ++i) {
      const std::int32_t ray = job.rays->met.ray[first + i];
      job.rays->depth[ray] = values[0][i];
      job.rays->z_left[ray] = values[1][i];
      job.rays->scalar_left[ray] = values[2][i];
    }
  }
};

/// Takes the rays of a tile through a brick, with effects.
template <class Integrator, bool kIsConstant>
class EffectMarcher {
 public:
  explicit EffectMarcher(const MarchJob& job) : job_(job), brick_(*job.brick), integrator_(*job.tables) {}

  std::uint64_t run(int count) {
    for (int first = 0; first < count; first += static_cast<int>(kLanes)) {
      const int lanes = std::min(count - first, static_cast<int>(kLanes));
      PassingRays rays(job_, first);
      if constexpr (kIsConstant)
        march_constants(first, lanes, rays);
      else
        march(first, lanes, rays);
      rays.store(job_, first, lanes);
    }
    return segments_;
  }

 private:
  void march(int first, int count, PassingRays& passing) {
    LatticeRays rays(*job_.rays, brick_, first, count);
    Accumulated sum = load_accumulated(*job_.rays, first);
    Float scalar_front = CellCorners(brick_, rays.cell).eval(rays, rays.front);
    scalar_front = hn::IfThenElse(hn::Eq(scalar_front, scalar_front), scalar_front, constant(0.0f));
    // Both sides of the plane between two bricks must agree to the bit on what the ray meets there.
    scalar_front = hn::IfThenElse(hn::Eq(rays.front, passing.z_left), passing.scalar_left, scalar_front);
    auto front = integrator_.front_at(scalar_front);
    while (!hn::AllFalse(kFloat, rays.alive)) {
      segments_ += hn::CountTrue(kFloat, rays.alive);
      const CellCorners corners(brick_, rays.cell);
      const Float back = rays.back();
      CellCubic cubic = make_cubic(corners, rays, back);
      Float length = hn::IfThenElseZero(rays.alive, hn::Mul(hn::Sub(back, rays.front), rays.world_per_z));
      if (HWY_UNLIKELY(brick_.has_missing)) {
        leave_out_missing(corners, cubic, length);
        scalar_front = cubic.c0;
        front = integrator_.front_at(scalar_front);
      }
      // Where a ray only touches a cell, rounding decides which one it is: what it says of the scalar must not count.
      const Float least = hn::Mul(constant(kRoundedDepth), hn::Max(hn::Abs(back), constant(1.0f)));
      const Mask touches = hn::Le(hn::Sub(back, rays.front), least);
      const Float scalar_back = hn::IfThenElse(touches, scalar_front, cubic.back());
      length = hn::IfThenZeroElse(touches, length);
      CellCubic others[kMostVariables];
      if constexpr (Integrator::kIsOfDomain) find_others(rays, back, others);
      const CellStretch stretch{scalar_front, scalar_back, rays.front, back,  length,
                                job_,         rays,        corners,    cubic, others};
      integrator_.integrate_stretch(stretch, passing.view, constant(0.0f), constant(1.0f), front, sum, passing.depth);
      scalar_front = scalar_back;
      passing.z_left = hn::IfThenElse(rays.alive, back, passing.z_left);
      passing.scalar_left = hn::IfThenElse(rays.alive, scalar_back, passing.scalar_left);
      rays.template advance<true>(back);  // a wrong cell may hold surfaces
    }
    store_accumulated(sum, job_, first, count);
  }

  /// Cubics of the other scalars that the function asks for.
  HWY_INLINE void find_others(const LatticeRays& rays, Float back, CellCubic others[kMostVariables]) const {
    for (int axis = 0; axis < kMostVariables; ++axis)
      if (const float* records = brick_.others[axis])
        others[axis] = make_cubic(CellCorners(brick_, records, rays.cell), rays, back);
  }

  void march_constants(int first, int count, PassingRays& passing) {
    LatticeRays rays(*job_.rays, brick_, first, count);
    Accumulated sum = load_accumulated(*job_.rays, first);
    while (!hn::AllFalse(kFloat, rays.alive)) {
      segments_ += hn::CountTrue(kFloat, rays.alive);
      const Float value = hn::GatherIndex(kFloat, brick_.constants, rays.cell);
      const Mask present = hn::And(rays.alive, hn::Eq(value, value));
      const Float scalar = hn::IfThenElseZero(hn::Eq(value, value), value);
      const Float back = rays.back();
      const Float length = hn::IfThenElseZero(present, hn::Mul(hn::Sub(back, rays.front), rays.world_per_z));
      const ConstantStretch stretch{scalar, scalar, rays.front, back, length, brick_, rays.cell};
      auto front = integrator_.front_at(scalar);
      integrator_.integrate_stretch(stretch, passing.view, constant(0.0f), constant(1.0f), front, sum, passing.depth);
      rays.advance(back);
    }
    store_accumulated(sum, job_, first, count);
  }

  const MarchJob& job_;
  const MarchBrick& brick_;
  Integrator integrator_;
  std::uint64_t segments_ = 0;
};

/// Takes the rays through a brick in equal steps (see stride-inl.h), with effects.
template <class Integrator>
class EffectStrider {
 public:
  explicit EffectStrider(const MarchJob& job)
      : job_(job), brick_(*job.brick), sampler_(brick_), integrator_(*job.tables) {}

  std::uint64_t run(int count) {
    for (int first = 0; first < count; first += static_cast<int>(kLanes))
      stride(first, std::min(count - first, static_cast<int>(kLanes)));
    return segments_;
  }

 private:
  void stride(int first, int count) {
    PassingRays passing(job_, first);
    const MarchRays::Met& met = job_.rays->met;
    const StridePlan plan(job_, first);
    Float at[3] = {plan.at[0], plan.at[1], plan.at[2]};
    Accumulated sum = load_accumulated(*job_.rays, first);
    Mask alive = hn::FirstN(kFloat, static_cast<std::size_t>(count));
    Float z = hn::LoadU(kFloat, met.z_enter + first);
    const Float z_leave = hn::LoadU(kFloat, met.z_leave + first);
    const Float z_step = hn::Div(hn::Sub(z_leave, z), plan.steps);
    Float scalar = hn::IfThenElse(hn::Eq(z, passing.z_left), passing.scalar_left, sampler_.eval(at));
    auto front = integrator_.front_at(scalar);
    for (Float number = constant(1.0f);; number = hn::Add(number, constant(1.0f))) {
      segments_ += hn::CountTrue(kFloat, alive);
      for (int axis = 0; axis < 3; ++axis) at[axis] = hn::Add(at[axis], plan.step[axis]);
      const Float back = sampler_.eval(at), z_back = hn::Add(z, z_step);
      const StepStretch stretch{scalar,   back, z,         z_back, hn::IfThenElseZero(alive, plan.length),
                                sampler_, at,   plan.step, brick_};
      integrator_.integrate_stretch(stretch, passing.view, constant(0.0f), constant(1.0f), front, sum, passing.depth);
      passing.scalar_left = hn::IfThenElse(alive, back, passing.scalar_left);
      scalar = back;
      z = z_back;
      alive = hn::And(alive, hn::Lt(number, plan.steps));
      if (hn::AllFalse(kFloat, alive)) break;
    }
    passing.z_left = z_leave;
    passing.store(job_, first, count);
    store_accumulated(sum, job_, first, count);
  }

  const MarchJob& job_;
  const MarchBrick& brick_;
  LatticeSampler sampler_;
  Integrator integrator_;
  std::uint64_t segments_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
