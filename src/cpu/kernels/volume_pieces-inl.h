// The volume between two cuts of a stretch: linear pieces, handed to an integrator one by one.

#if defined(TETRAVOX_CPU_VOLUME_PIECES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_VOLUME_PIECES_INL
#undef TETRAVOX_CPU_VOLUME_PIECES_INL
#else
#define TETRAVOX_CPU_VOLUME_PIECES_INL
#endif

#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/lit_places-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// What one call works on.
template <class Front, class Stretch>
struct Walk {
  const Stretch& stretch;
  const RayView& ray;
  Front& front;
  Accumulated& sum;
  Float& depth;
};

/// What the volume between two cuts emits and absorbs, and where.
struct Gathered {
  Accumulated part;  ///< its transmittance is that behind it
  Emission emission;
  Float absorbed;
  Mask bright;  ///< worth a normal
};

/// Integrates pieces of stretches by `Base`.
template <class Base>
class PieceIntegrator {
 public:
  using Front = typename Base::Front;
  /// Whether the integrator asks stretches for more than the scalar (domain-inl.h).
  static constexpr bool kIsOfDomain = requires { Base::kIsOfDomain; };

  explicit PieceIntegrator(const IntegratorTables& tables) : base_(tables), effects_(*tables.effects) {}

  const Base& base() const { return base_; }

  HWY_INLINE bool is_weighted() const { return effects_.weight_by_change > 0.0f || effects_.weight_by_gradient > 0.0f; }

  /// What comes through from `begin` to `end`.
  template <class Stretch>
  HWY_INLINE Float pass_unlit(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end) const {
    const Float zero = constant(0.0f);
    Accumulated part{zero, zero, zero, walk.sum.transmittance};
    const Front front = walk.front;
    const Float depth = walk.depth;
    integrate(walk, begin, end, part, nullptr);
    walk.front = front;
    walk.depth = depth;
    return part.transmittance;
  }

  /// Adds linear pieces to `sum`, and says where they absorb, if that is asked for. What one ray is given does not
  /// depend on those beside it.
  template <class Stretch>
  HWY_NOINLINE void integrate(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end, Accumulated& sum,
                              Emission* emission) const {
    if constexpr (kIsOfDomain) {
      base_.integrate_stretch(
          walk.stretch, begin, end, sum, emission,
          [&](const Cut& a, const Cut& b) { return segment_between(walk.stretch, a, b).length; },
          [&](const Cut& a, const Cut& b, Float before) { note_piece(walk, a, b, before, sum.transmittance); });
    } else if constexpr (Stretch::kIsLinear) {
      integrate_piece(walk, begin, end, sum, emission);
    } else {
      const Float pieces = walk.stretch.count_pieces(begin, end, sum.transmittance);
      const Float share = hn::Div(hn::Sub(end.u, begin.u), pieces);
      Cut at = begin;
      for (Float number = constant(1.0f);; number = hn::Add(number, constant(1.0f))) {
        const Mask last = hn::Ge(number, pieces);
        Cut next = end;
        if (!hn::AllTrue(kFloat, last)) {
          next = cut_at(walk.stretch, multiply_add(number, share, begin.u));
          next = {hn::IfThenElse(last, end.u, next.u), hn::IfThenElse(last, end.scalar, next.scalar)};
        }
        integrate_piece(walk, at, next, sum, emission);
        if (hn::AllTrue(kFloat, last)) return;
        at = next;
      }
    }
  }

  template <class Stretch>
  HWY_INLINE Gathered gather(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end) const {
    const Float zero = constant(0.0f);
    Gathered gathered{
        {zero, zero, zero, walk.sum.transmittance}, {zero, zero, zero, zero}, zero, hn::FirstN(kFloat, 0)};
    integrate(walk, begin, end, gathered.part, &gathered.emission);
    gathered.absorbed = hn::Sub(walk.sum.transmittance, gathered.part.transmittance);
    gathered.bright = hn::Gt(gathered.absorbed, constant(effects_.faint));
    return gathered;
  }

 private:
  /// One linear piece. Where its emission lies is looked up if it is the only one.
  template <class Stretch>
  HWY_INLINE void integrate_piece(const Walk<Front, Stretch>& walk, const Cut& a, const Cut& b, Accumulated& sum,
                                  Emission* emission) const {
    const Float before = sum.transmittance;
    const Segments segment = segment_between(walk.stretch, a, b);
    base_.integrate(segment, walk.front, sum);
    if (emission) note_emission(effects_, segment, a, b, before, sum.transmittance, *emission);
    note_piece(walk, a, b, before, sum.transmittance);
  }

  /// The piece of a stretch between two cuts, weighed.
  template <class Stretch>
  HWY_INLINE Segments segment_between(const Stretch& stretch, const Cut& a, const Cut& b) const {
    const Float part = hn::Max(hn::Sub(b.u, a.u), constant(0.0f));
    Segments segment{a.scalar, b.scalar, hn::Mul(stretch.length, part)};
    if (HWY_UNLIKELY(is_weighted())) weigh(effects_, stretch, a, b, segment);
    return segment;
  }

  /// Writes down what depths ask for of a piece: transmittance before and after it.
  template <class Stretch>
  HWY_INLINE void note_piece(const Walk<Front, Stretch>& walk, const Cut& a, const Cut& b, Float before,
                             Float after) const {
    if (effects_.depth) note_depth(walk.stretch, a, b, before, after, walk.depth);
    if (HWY_LIKELY(effects_.record == nullptr)) return;
    const Mask takes_part = hn::Gt(walk.stretch.length, constant(0.0f));
    const Float z_begin = depth_at(walk.stretch, a.u);
    const Float z[2] = {z_begin, hn::IfThenElse(takes_part, depth_at(walk.stretch, b.u), z_begin)};
    const Float ends[2] = {before, after};
    record_depths(*effects_.record, walk.ray.pixels, z, ends);
  }

  Base base_;
  const Effects& effects_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
