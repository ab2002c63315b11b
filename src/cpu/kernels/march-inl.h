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
#include "src/cpu/kernels/rays-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The scalar along a vector of rays inside their cells: a cubic of u, 0 at the front and 1 at the back.
struct CellCubic {
  Float c0, c1, c2, c3;

  HWY_INLINE Float eval(Float u) const { return multiply_add(u, multiply_add(u, multiply_add(u, c3, c2), c1), c0); }
  HWY_INLINE Float back() const { return hn::Add(hn::Add(c0, c1), hn::Add(c2, c3)); }

  /// Bound on the distance from the chord: u (u - 1) (c2 + c3 (1 + u)).
  HWY_INLINE Float bend() const {
    const Float near = hn::Abs(hn::Add(c2, c3)), far = hn::Abs(hn::Add(c2, hn::Add(c3, c3)));
    return hn::Mul(constant(0.25f), hn::Max(near, far));
  }

  /// Becomes constant 0 where `mask` is set.
  HWY_INLINE void clear(Mask mask) {
    for (Float* c : {&c0, &c1, &c2, &c3}) *c = hn::IfThenZeroElse(mask, *c);
  }
};

HWY_INLINE CellCubic make_cubic(const CellCorners& corners, const LatticeRays& rays, Float back) {
  Float front_place[3], step[3];
  for (int axis = 0; axis < 3; ++axis) {
    front_place[axis] = rays.place(axis, rays.front);
    step[axis] = hn::Sub(rays.place(axis, back), front_place[axis]);
  }
  const auto [x, y, z] = front_place;
  const auto [dx, dy, dz] = step;
  const Float xy_slope = multiply_add(x, dy, hn::Mul(y, dx)), xy_bend = hn::Mul(dx, dy);
  // The lower square is a + b x + c y + d xy, which along the ray is a quadratic; so is what the upper one adds.
  const auto along = [&](const Record& r, Float quadratic[3]) {
    const Float b = hn::Sub(r.y, r.x), c = hn::Sub(r.z, r.x), d = hn::Sub(hn::Sub(r.w, r.y), c);
    quadratic[0] = hn::Add(r.x, multiply_add(b, x, hn::Mul(multiply_add(d, x, c), y)));
    quadratic[1] = multiply_add(b, dx, multiply_add(c, dy, hn::Mul(d, xy_slope)));
    quadratic[2] = hn::Mul(d, xy_bend);
  };
  Float low[3], rise[3];
  along(corners.low, low);
  along({hn::Sub(corners.high.x, corners.low.x), hn::Sub(corners.high.y, corners.low.y),
         hn::Sub(corners.high.z, corners.low.z), hn::Sub(corners.high.w, corners.low.w)},
        rise);
  return {multiply_add(z, rise[0], low[0]), multiply_add(dz, rise[0], multiply_add(z, rise[1], low[1])),
          multiply_add(dz, rise[1], multiply_add(z, rise[2], low[2])), hn::Mul(dz, rise[2])};
}

/// Largest of `values`, one of the two of a table, over a range of scalars (see optics::SteepnessTable).
HWY_INLINE Float find_largest(const optics::SteepnessTable& table, const std::vector<float>& values, Float low,
                              Float high) {
  const auto bin = [&](Float scalar) {
    const Float at = hn::Mul(hn::Sub(scalar, constant(table.first)), constant(table.bins_per_scalar));
    return round_small(hn::Floor(hn::Min(hn::Max(at, constant(0.0f)), constant(optics::SteepnessTable::kBins - 1))));
  };
  const Int first = bin(low), last = bin(high);
  const Int count = hn::Add(hn::Sub(last, first), hn::Set(kInt, 1));
  // The exponent of a float is the logarithm of the number.
  const Int level = hn::Sub(hn::ShiftRight<23>(hn::BitCast(kInt, hn::ConvertTo(kFloat, count))), hn::Set(kInt, 127));
  const Int width = hn::BitCast(kInt, hn::ShiftLeft<23>(hn::Add(level, hn::Set(kInt, 127))));
  const Int bins = hn::ConvertTo(kInt, hn::BitCast(kFloat, width));
  const Int row = hn::Mul(level, hn::Set(kInt, optics::SteepnessTable::kBins));
  const Int end = hn::Add(hn::Sub(last, bins), hn::Set(kInt, 1));
  return hn::Max(hn::GatherIndex(kFloat, values.data(), hn::Add(row, first)),
                 hn::GatherIndex(kFloat, values.data(), hn::Add(row, end)));
}

/// Largest change of density with the scalar over a range.
HWY_INLINE Float find_steepness(const optics::SteepnessTable& table, Float low, Float high) {
  return find_largest(table, table.steepness, low, high);
}

/// A cell with a corner that is missing is transparent; behind it the ray sets out anew.
HWY_NOINLINE inline void leave_out_missing(const CellCorners& corners, CellCubic& cubic, Float& length) {
  const Mask missing = corners.is_missing();
  cubic.clear(missing);
  length = hn::IfThenZeroElse(missing, length);
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
    Accumulated sum = load_accumulated(*job_.rays, first);
    Float scalar_front = CellCorners(brick_, rays.cell).eval(rays, rays.front);
    scalar_front = hn::IfThenElse(hn::Eq(scalar_front, scalar_front), scalar_front, constant(0.0f));
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
      const Float scalar_back = cubic.back();
      integrate(cubic, {scalar_front, scalar_back, length}, front, sum);
      scalar_front = scalar_back;
      rays.advance(back);
    }
    store_accumulated(sum, job_, first, count);
  }

  /// Integrates the cubic in as many linear pieces as its distance from the chord, the steepness of the function and
  /// what still comes through ask for.
  HWY_INLINE void integrate(const CellCubic& cubic, const Segments& segment, typename Integrator::Front& front,
                            Accumulated& sum) const {
    const Float bend = hn::Mul(sum.transmittance, cubic.bend());
    const Mask bent = hn::And(hn::Gt(hn::Mul(bend, constant(brick_.steepness)), constant(job_.allowed_rate)),
                              hn::Gt(segment.length, constant(0.0f)));
    if (HWY_LIKELY(hn::AllFalse(kFloat, bent)))
      integrator_.integrate(segment, front, sum);
    else
      integrate_pieces(cubic, hn::IfThenElseZero(bent, bend), segment, front, sum);
  }

  HWY_NOINLINE void integrate_pieces(const CellCubic& cubic, Float bend, const Segments& segment,
                                     typename Integrator::Front& front, Accumulated& sum) const {
    const Float margin = hn::Mul(constant(1.5f), cubic.bend());
    const Float low = hn::Sub(hn::Min(segment.scalar_front, segment.scalar_back), margin);
    const Float high = hn::Add(hn::Max(segment.scalar_front, segment.scalar_back), margin);
    const Float rate = hn::Mul(bend, find_steepness(*job_.steepness, low, high));
    const Float wanted = hn::Ceil(hn::Sqrt(hn::Mul(rate, constant(1.0f / job_.allowed_rate))));
    const Float pieces = hn::Min(hn::Max(wanted, constant(1.0f)), constant(job_.most_pieces));
    const Float share = hn::Div(constant(1.0f), pieces);
    const Float piece_length = hn::Mul(segment.length, share);
    Segments piece{segment.scalar_front, segment.scalar_front, piece_length};
    Float number = constant(1.0f);
    for (;;) {
      const Mask last = hn::Ge(number, pieces);
      piece.scalar_back = hn::IfThenElse(last, segment.scalar_back, cubic.eval(hn::Mul(number, share)));
      integrator_.integrate(piece, front, sum);
      if (hn::AllTrue(kFloat, last)) return;
      piece.length = hn::IfThenZeroElse(last, piece.length);
      piece.scalar_front = piece.scalar_back;
      number = hn::Add(number, constant(1.0f));
    }
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
    Accumulated sum = load_accumulated(*job.rays, first);
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
