// Integrators of functions of several variables, and of colour from another array than opacity.

#if defined(TETRAVOX_CPU_DOMAIN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_DOMAIN_INL
#undef TETRAVOX_CPU_DOMAIN_INL
#else
#define TETRAVOX_CPU_DOMAIN_INL
#endif

#include "src/cpu/kernels/domain.h"
#include "src/cpu/kernels/domain_functions-inl.h"
#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <initializer_list>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// A part of a path on which extinction and colour are polynomials, known where it begins, in its middle and where it
/// ends.
struct DomainPart {
  Record front, middle, back;
  Float length;

  /// Optical depth: Simpson's rule, exact in a box of two or three variables.
  HWY_INLINE Float depth() const {
    const Float sum = multiply_add(constant(4.0f), middle.x, hn::Add(front.x, back.x));
    return hn::Mul(hn::Mul(sum, constant(1.0f / 6.0f)), length);
  }
  /// How much the colour changes, in its largest channel.
  HWY_INLINE Float color_change() const {
    const auto channel = [](Float a, Float b, Float c) { return hn::Add(hn::AbsDiff(a, b), hn::AbsDiff(b, c)); };
    return hn::Max(channel(front.y, middle.y, back.y),
                   hn::Max(channel(front.z, middle.z, back.z), channel(front.w, middle.w, back.w)));
  }
  /// Where in it the extinction has its centre, from 0 to 1.
  HWY_INLINE Float centroid() const {
    const Float below = multiply_add(constant(4.0f), middle.x, hn::Add(front.x, back.x));
    const Float above = multiply_add(constant(2.0f), middle.x, back.x);
    return hn::Div(above, hn::Max(below, constant(1e-30f)));
  }
};

/// Adds a part whose optical depth is `depth`, at most 1.
///
/// With w from 0 to 1 as the optical depth grows, the colour is taken as linear in w: mean c, change dc. Its emission
/// is then c (1 - exp(-tau)) - dc tau^2 exp(-tau / 2) (1/12 + tau^2 / 480 + ...). The mean is exact for colour and
/// extinction that are quadratics. With 1 - exp(-tau) = 2 exp(-tau / 2) sinh(tau / 2) one exponential serves for both.
HWY_INLINE void composite_part(const DomainPart& part, Float depth, Accumulated& sum) {
  const Float f = part.front.x, m = part.middle.x, b = part.back.x;
  const auto weigh = [](float p, Float x, float q, Float y, float r, Float z) {
    return multiply_add(constant(p), x, multiply_add(constant(q), y, hn::Mul(constant(r), z)));
  };
  const auto polynomial = [](Float x, std::initializer_list<float> descending) {
    Float value = constant(0.0f);
    for (const float coefficient : descending) value = multiply_add(value, x, constant(coefficient));
    return value;
  };
  const Float half = hn::Mul(depth, constant(0.5f)), square = hn::Mul(half, half);
  const Float through_half =
      polynomial(half, {-1.0f / 5040, 1.0f / 720, -1.0f / 120, 1.0f / 24, -1.0f / 6, 0.5f, -1.0f, 1.0f});
  const Float ratio = hn::Mul(through_half, polynomial(square, {1.0f / 5040, 1.0f / 120, 1.0f / 6, 1.0f}));
  const Float lag = hn::Mul(hn::Mul(square, through_half), polynomial(square, {1.0f / 30, 1.0f / 3}));  // 4/12, 16/480

  const Float share = hn::Mul(hn::Mul(part.length, ratio), constant(1.0f / 30.0f));
  const Float weights[3] = {multiply_add(share, weigh(4.0f, f, 2.0f, m, -1.0f, b), lag),
                            hn::Mul(share, weigh(2.0f, f, 16.0f, m, 2.0f, b)),
                            hn::Sub(hn::Mul(share, weigh(-1.0f, f, 2.0f, m, 4.0f, b)), lag)};
  const auto channel = [&](Float c0, Float c1, Float c2, Float so_far) {
    const Float color = multiply_add(weights[0], c0, multiply_add(weights[1], c1, hn::Mul(weights[2], c2)));
    return multiply_add(sum.transmittance, hn::Max(color, constant(0.0f)), so_far);
  };
  sum.red = channel(part.front.y, part.middle.y, part.back.y, sum.red);
  sum.green = channel(part.front.z, part.middle.z, part.back.z, sum.green);
  sum.blue = channel(part.front.w, part.middle.w, part.back.w, sum.blue);
  sum.transmittance = hn::Sub(sum.transmittance, hn::Mul(sum.transmittance, hn::Mul(ratio, depth)));
}

/// Integrates pieces on which all variables are linear, from box to box of the function's domain (as Amanatides and Woo
/// 1987 go through space): in each box extinction and colour are polynomials. So a piece has as many samples as its
/// extent in the domain asks for, and more where it is thick.
template <class Function>
class DomainIntegrator : public WithoutFront {
 public:
  static constexpr bool kIsOfDomain = true;

  explicit DomainIntegrator(const IntegratorTables& tables)
      : function_(tables),
        domain_(*tables.domain),
        effects_(*tables.effects),
        threshold_(kErrorOfSlope * tables.tolerance) {}

  /// Adds the part of a stretch between two cuts in linear pieces. `find_length(a, b)`: world length of the piece
  /// between two cuts; `note(a, b, before)`: told of each piece, with the transmittance before it. `moment`: where
  /// there is one, what is absorbed times where (as u of the stretch) is added to it.
  template <class Stretch, class FindLength, class Note>
  HWY_NOINLINE void integrate_stretch(const Stretch& stretch, const Cut& begin, const Cut& end, Accumulated& sum,
                                      Float* moment, const FindLength& find_length, const Note& note) const {
    Place at = place_at(stretch, begin), last_place = place_at(stretch, end);
    const Range range = find_range(stretch, at, last_place);
    const Mask seen = hn::And(hn::Gt(stretch.length, constant(0.0f)), function_.is_occupied(range.low, range.high));
    if (hn::AllFalse(kFloat, seen)) return note(begin, end, sum.transmittance);
    add_gradient(stretch, begin, at);
    add_gradient(stretch, end, last_place);
    const Float one = constant(1.0f);
    const Float pieces =
        hn::IfThenElse(seen, count_pieces(stretch, {begin, end, at, last_place}, range, sum.transmittance), one);
    const Float share = hn::Div(hn::Sub(end.u, begin.u), pieces);
    Cut cut = begin;
    for (Float number = one;; number = hn::Add(number, one)) {
      const Mask last = hn::Ge(number, pieces);
      Cut next = end;
      Place next_place = last_place;
      if (!hn::AllTrue(kFloat, last)) {
        next = cut_at(stretch, multiply_add(number, share, begin.u));
        next = {hn::IfThenElse(last, end.u, next.u), hn::IfThenElse(last, end.scalar, next.scalar)};
        next_place = place_at(stretch, next);
        add_gradient(stretch, next, next_place);
      }
      const Float before = sum.transmittance;
      const Piece piece{cut, next, at, next_place};
      integrate_piece(piece, hn::IfThenElseZero(seen, find_length(cut, next)), sum, moment);
      note(cut, next, before);
      if (hn::AllTrue(kFloat, last)) return;
      cut = next;
      at = next_place;
    }
  }

 private:
  static constexpr int kCount = Function::kCount;
  /// The colour is not quite linear in the optical depth: by dc tau^2 / 60 at worst.
  static constexpr float kErrorOfSlope = 60.0f;
  /// The series of `composite_part` are good up to this optical depth.
  static constexpr float kDeepest = 1.0f;
  static constexpr float kShortest = 1e-6f;
  static constexpr float kLeftOver = 1e-6f;

  /// Where a place of a stretch lies in the domain.
  struct Place {
    Float coordinates[kCount];
    Triple gradient;
  };
  struct Piece {
    const Cut &a, &b;
    const Place &front, &back;
  };

  /// All but the gradient.
  template <class Stretch>
  HWY_INLINE Place place_at(const Stretch& stretch, const Cut& cut) const {
    const Float zero = constant(0.0f);
    Place place;
    place.gradient = {zero, zero, zero};
    for (int axis = 0; axis < kCount; ++axis) {
      const DomainAxis::Source source = domain_.axes[axis].source;
      Float scalar = cut.scalar;
      if (source == DomainAxis::Source::kOther) scalar = stretch.other(axis, cut.u);
      place.coordinates[axis] = source == DomainAxis::Source::kGradient ? zero : function_.coordinate(axis, scalar);
    }
    return place;
  }

  template <class Stretch>
  HWY_INLINE void add_gradient(const Stretch& stretch, const Cut& cut, Place& place) const {
    if (domain_.gradient_axis < 0) return;
    place.gradient = gradient_at(effects_, stretch, cut.u);
    const Float magnitude = function_.coordinate(domain_.gradient_axis, magnitude_of(place.gradient));
    for (int axis = 0; axis < kCount; ++axis)
      if (axis == domain_.gradient_axis) place.coordinates[axis] = magnitude;
  }

  static HWY_INLINE Float magnitude_of(const Triple& gradient) { return hn::Sqrt(dot(gradient, gradient)); }

  /// Distance of what an axis is given from its chord, along the whole stretch.
  template <class Stretch>
  static HWY_INLINE Float bend_of(const Stretch& stretch, DomainAxis::Source source, int axis) {
    if constexpr (Stretch::kIsLinear)
      return constant(0.0f);
    else
      return source == DomainAxis::Source::kScalar ? stretch.bend() : stretch.other_bend(axis);
  }

  /// What coordinates a stretch may take, whatever the gradient.
  struct Range {
    Float low[kCount], high[kCount];
  };
  template <class Stretch>
  HWY_INLINE Range find_range(const Stretch& stretch, const Place& a, const Place& b) const {
    Range range;
    Float *low = range.low, *high = range.high;
    const auto present = [](Float x) { return hn::IfThenElseZero(hn::Eq(x, x), x); };
    for (int axis = 0; axis < kCount; ++axis) {
      const DomainAxis& of = domain_.axes[axis];
      low[axis] = hn::Min(present(a.coordinates[axis]), present(b.coordinates[axis]));
      high[axis] = hn::Max(present(a.coordinates[axis]), present(b.coordinates[axis]));
      if (of.source == DomainAxis::Source::kGradient) {
        low[axis] = constant(0.0f);
        high[axis] = constant(static_cast<float>(of.last));
      } else if constexpr (!Stretch::kIsLinear) {
        const Float margin =
            hn::Mul(constant(1.5f * of.entries_per_scalar), present(bend_of(stretch, of.source, axis)));
        low[axis] = hn::Sub(low[axis], margin);
        high[axis] = hn::Add(high[axis], margin);
      }
    }
    return range;
  }

  /// Linear pieces that a stretch needs for what is bent in it.
  template <class Stretch>
  HWY_INLINE Float count_pieces(const Stretch& stretch, const Piece& whole, const Range& range,
                                Float transmittance) const {
    const Float part = hn::Sub(whole.b.u, whole.a.u), square = hn::Mul(part, part);
    Float rate = constant(0.0f);
    for (int axis = 0; axis < kCount; ++axis) {
      const DomainAxis& of = domain_.axes[axis];
      const bool is_gradient = of.source == DomainAxis::Source::kGradient;
      if (of.steepness == 0.0f || (Stretch::kIsLinear && !is_gradient)) continue;
      Float bend = is_gradient ? bend_of_magnitude(stretch, whole) : hn::Mul(square, bend_of(stretch, of.source, axis));
      bend = hn::IfThenElseZero(hn::Eq(bend, bend), bend);  // of missing values nothing is drawn
      rate = multiply_add(bend, function_.find_steepness_of(axis, range.low, range.high), rate);
    }
    const Float error = hn::Mul(hn::Mul(rate, transmittance), constant(1.0f / domain_.allowed_rate));
    return hn::Min(hn::Max(hn::Ceil(hn::Sqrt(error)), constant(1.0f)), constant(domain_.most_pieces));
  }

  /// How far the gradient magnitude strays from its chord. Where the gradient is linear, it is convex.
  template <class Stretch>
  HWY_INLINE Float bend_of_magnitude(const Stretch& stretch, const Piece& whole) const {
    const Float half = constant(0.5f);
    const Triple &a = whole.front.gradient, &b = whole.back.gradient;
    const Float chord = hn::Mul(half, hn::Add(magnitude_of(a), magnitude_of(b)));
    Triple middle = scaled(sum_of(a, b), half);
    if constexpr (!Stretch::kIsLinear)
      middle = gradient_at(effects_, stretch, hn::Mul(half, hn::Add(whole.a.u, whole.b.u)));
    return hn::AbsDiff(chord, magnitude_of(middle));
  }

  HWY_INLINE void integrate_piece(const Piece& piece, Float length, Accumulated& sum, Float* moment) const {
    DomainPath<kCount> path;
    Mask active = hn::Gt(length, constant(0.0f));
    for (int axis = 0; axis < kCount; ++axis) {
      const Float front = piece.front.coordinates[axis], back = piece.back.coordinates[axis];
      // What is missing is transparent.
      const Mask present = hn::And(hn::Eq(front, front), hn::Eq(back, back));
      active = hn::And(active, present);
      path.set(axis, hn::IfThenElseZero(present, front), hn::IfThenElseZero(present, back));
    }
    if (hn::AllFalse(kFloat, active)) return;
    const Float share = hn::Sub(piece.b.u, piece.a.u);
    follow(path, length, active, sum, [&](Float from, Float to, const DomainPart& part, Float absorbed) {
      if (!moment) return;
      const Float place = multiply_add(multiply_add(part.centroid(), hn::Sub(to, from), from), share, piece.a.u);
      *moment = multiply_add(absorbed, place, *moment);
    });
  }

  static HWY_INLINE Record choose(Mask mask, const Record& a, const Record& b) {
    return {hn::IfThenElse(mask, a.x, b.x), hn::IfThenElse(mask, a.y, b.y), hn::IfThenElse(mask, a.z, b.z),
            hn::IfThenElse(mask, a.w, b.w)};
  }

  /// Calls `note(from, to, part, absorbed)` for each part that is added.
  template <class Note>
  HWY_INLINE void follow(const DomainPath<kCount>& path, Float length, Mask active, Accumulated& sum,
                         const Note& note) const {
    const Float zero = constant(0.0f), one = constant(1.0f), half = constant(0.5f);
    typename Function::Box box = function_.start(path);
    Float at = zero, step = one;
    Record front = function_.eval(path, function_.load(box), at);
    do {
      Float borders[kCount], border = one;
      for (int axis = 0; axis < kCount; ++axis) {
        borders[axis] = hn::Max(function_.border(path, box, axis), at);
        border = hn::Min(border, borders[axis]);
      }
      const Float next = hn::Min(border, hn::Add(at, step));
      const typename Function::Corners corners = function_.load(box);
      if constexpr (!Function::kIsContinuous) front = function_.eval(path, corners, at);
      const DomainPart part{front, function_.eval(path, corners, hn::Mul(half, hn::Add(at, next))),
                            function_.eval(path, corners, next), hn::Mul(length, hn::Sub(next, at))};
      const Float depth = part.depth();
      const Float error = hn::Mul(hn::Mul(hn::Mul(depth, depth), part.color_change()), sum.transmittance);
      const Mask fine = hn::And(hn::Le(depth, constant(kDeepest)), hn::Le(error, constant(threshold_)));
      const Mask accepted = hn::And(active, hn::Or(fine, hn::Le(hn::Sub(next, at), constant(kShortest))));
      const Float before = sum.transmittance;
      Accumulated with = sum;
      composite_part(part, depth, with);
      sum.red = hn::IfThenElse(accepted, with.red, sum.red);
      sum.green = hn::IfThenElse(accepted, with.green, sum.green);
      sum.blue = hn::IfThenElse(accepted, with.blue, sum.blue);
      sum.transmittance = hn::IfThenElse(accepted, with.transmittance, sum.transmittance);
      note(at, next, part, hn::Sub(before, sum.transmittance));
      for (int axis = 0; axis < kCount; ++axis)
        function_.cross(path, hn::And(accepted, hn::Le(borders[axis], next)), axis, box);
      step = hn::IfThenElse(accepted, hn::Add(step, step), hn::Mul(half, hn::Sub(next, at)));
      at = hn::IfThenElse(accepted, next, at);
      if constexpr (Function::kIsContinuous) front = choose(accepted, part.back, front);
      // What comes after a millionth of the light has no colour to add.
      active = hn::And(active, hn::And(hn::Lt(at, one), hn::Gt(sum.transmittance, constant(kLeftOver))));
    } while (!hn::AllFalse(kFloat, active));
  }

  Function function_;
  const DomainFunction& domain_;
  const Effects& effects_;
  float threshold_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
