// Integrators of functions of several variables, and of colour from another array than opacity.

#if defined(TETRAVOX_CPU_DOMAIN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_DOMAIN_INL
#undef TETRAVOX_CPU_DOMAIN_INL
#else
#define TETRAVOX_CPU_DOMAIN_INL
#endif

#include "src/cpu/kernels/domain.h"
#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The straight way of a vector of rays through the domain, u from 0 to 1.
template <int kCount>
struct DomainPath {
  Float begin[kCount], span[kCount];

  HWY_INLINE Float at(int axis, Float u) const { return multiply_add(u, span[axis], begin[axis]); }
  /// Where it meets `value`; never where it does not move.
  HWY_INLINE Float meets(int axis, Float value) const {
    const Mask level = hn::Eq(span[axis], constant(0.0f));
    const Float u = hn::Div(hn::Sub(value, begin[axis]), hn::IfThenElse(level, constant(1.0f), span[axis]));
    return hn::IfThenElse(level, constant(2.0f), u);
  }
};

/// Extinction and colour of a table, multilinear between its entries. Paths are in entries.
template <int kVariables>
class TableFunction {
 public:
  static constexpr int kCount = kVariables;
  using Path = DomainPath<kCount>;

  explicit TableFunction(const IntegratorTables& tables) : domain_(*tables.domain) {
    std::int32_t stride = 1;
    for (int axis = 0; axis < kCount; ++axis) {
      strides_[axis] = stride;
      stride *= domain_.axes[axis].last + 1;
    }
  }

  HWY_INLINE Float coordinate(int axis, Float scalar) const {
    const DomainAxis& a = domain_.axes[axis];
    return hn::Mul(hn::Sub(scalar, constant(a.first)), constant(a.entries_per_scalar));
  }

  /// The box between entries that a path is in: the number of its lower entry along each axis, -1 below the table, the
  /// last one above it.
  struct Box {
    Float number[kCount];
  };
  HWY_INLINE Box start(const Path& path) const {
    Box box;
    for (int axis = 0; axis < kCount; ++axis) {
      const Float at = hn::Min(hn::Max(path.begin[axis], constant(-1.0f)), last(axis)), floor = hn::Floor(at);
      // A path that falls from an entry is in the box below.
      const Mask falls = hn::And(hn::Lt(path.span[axis], constant(0.0f)), hn::Eq(floor, path.begin[axis]));
      box.number[axis] = hn::IfThenElse(falls, hn::Sub(floor, constant(1.0f)), floor);
    }
    return box;
  }
  /// Where the path leaves its box along an axis.
  HWY_INLINE Float border(const Path& path, const Box& box, int axis) const {
    const Mask rising = hn::Gt(path.span[axis], constant(0.0f));
    const Float value = hn::IfThenElse(rising, hn::Add(box.number[axis], constant(1.0f)), box.number[axis]);
    const Mask outside = hn::Or(hn::Lt(value, constant(0.0f)), hn::Gt(value, last(axis)));
    return hn::IfThenElse(outside, constant(2.0f), path.meets(axis, value));
  }
  HWY_INLINE void cross(const Path& path, Mask lanes, int axis, Box& box) const {
    const Float step = hn::CopySign(constant(1.0f), path.span[axis]);
    box.number[axis] = hn::Add(box.number[axis], hn::IfThenElseZero(lanes, step));
  }

  /// What is to be known of a box to evaluate the function in it.
  struct Corners {
    Float number[kCount];
    Record entries[1 << kCount];
  };
  HWY_INLINE Corners load(const Box& box) const {
    Corners corners;
    Float node = constant(0.0f);
    for (int axis = 0; axis < kCount; ++axis) {
      corners.number[axis] = hn::Min(hn::Max(box.number[axis], constant(0.0f)), hn::Sub(last(axis), constant(1.0f)));
      node = multiply_add(corners.number[axis], constant(static_cast<float>(strides_[axis])), node);
    }
    const Uint index = hn::BitCast(kUint, hn::ConvertTo(kInt, node));
    for (int corner = 0; corner < 1 << kCount; ++corner) {
      std::int32_t offset = 0;
      for (int axis = 0; axis < kCount; ++axis) offset += (corner >> axis & 1) * strides_[axis];
      corners.entries[corner] =
          load_table_records(domain_.entries, hn::Add(index, hn::Set(kUint, static_cast<std::uint32_t>(offset))));
    }
    return corners;
  }
  HWY_INLINE Record eval(const Path& path, const Corners& corners, Float u) const {
    Record mixed[1 << (kCount - 1)];
    for (int axis = 0; axis < kCount; ++axis) {
      const Float off = hn::Sub(path.at(axis, u), corners.number[axis]);
      const Float t = hn::Min(hn::Max(off, constant(0.0f)), constant(1.0f));
      const Record* from = axis == 0 ? corners.entries : mixed;
      for (int i = 0; i < 1 << (kCount - 1 - axis); ++i) mixed[i] = mix_records(t, from[2 * i], from[2 * i + 1]);
    }
    return mixed[0];
  }

 private:
  static HWY_INLINE Record mix_records(Float t, const Record& a, const Record& b) {
    const auto channel = [&](Float p, Float q) { return multiply_add(t, hn::Sub(q, p), p); };
    return {channel(a.x, b.x), channel(a.y, b.y), channel(a.z, b.z), channel(a.w, b.w)};
  }
  HWY_INLINE Float last(int axis) const { return constant(static_cast<float>(domain_.axes[axis].last)); }

  const DomainFunction& domain_;
  std::int32_t strides_[kCount];
};

/// Extinction by the scalar, colour by another: both linear between their control points. Paths are in stored scalars.
class SeparateFunction {
 public:
  static constexpr int kCount = 2;
  using Path = DomainPath<kCount>;

  explicit SeparateFunction(const IntegratorTables& tables)
      : points_{ControlPoints(*tables.control_points), ControlPoints(*tables.domain->colors)} {}

  HWY_INLINE Float coordinate(int, Float scalar) const { return scalar; }

  /// The intervals between control points that a path is in.
  struct Box {
    Int interval[kCount];
  };
  using Corners = Box;
  HWY_INLINE Box start(const Path& path) const {
    Box box;
    for (int axis = 0; axis < kCount; ++axis)
      box.interval[axis] = points_[axis].find_front_interval(path.begin[axis], hn::Ge(path.span[axis], constant(0.0f)));
    return box;
  }
  HWY_INLINE Float border(const Path& path, const Box& box, int axis) const {
    const Mask rising = hn::Ge(path.span[axis], constant(0.0f));
    const Int side = hn::IfThenElseZero(int_mask(rising), hn::Set(kInt, 1));
    return path.meets(axis, points_[axis].start_of(hn::Add(box.interval[axis], side)));
  }
  HWY_INLINE void cross(const Path& path, Mask lanes, int axis, Box& box) const {
    const Mask rising = hn::Ge(path.span[axis], constant(0.0f));
    const Int step = hn::IfThenElse(int_mask(rising), hn::Set(kInt, 1), hn::Set(kInt, -1));
    box.interval[axis] = hn::Add(box.interval[axis], hn::IfThenElseZero(int_mask(lanes), step));
  }
  HWY_INLINE Corners load(const Box& box) const { return box; }
  HWY_INLINE Record eval(const Path& path, const Corners& box, Float u) const {
    const Float extinction = points_[0].eval(box.interval[0], path.at(0, u)).x;
    const Record color = points_[1].eval(box.interval[1], path.at(1, u));
    return {extinction, color.y, color.z, color.w};
  }

 private:
  ControlPoints points_[kCount];
};

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

/// Adds a part whose optical depth is `depth`, at most about 1.
///
/// With w from 0 to 1 as the optical depth grows, the colour is taken as linear in w: mean c, change dc. Its emission
/// is then c (1 - exp(-tau)) - dc tau^2 exp(-tau / 2) (1/12 + tau^2 / 480 + ...). The mean is exact for colour and
/// extinction that are quadratics.
HWY_INLINE void composite_part(const DomainPart& part, Float depth, Accumulated& sum) {
  const Float f = part.front.x, m = part.middle.x, b = part.back.x;
  const auto weigh = [](float p, Float x, float q, Float y, float r, Float z) {
    return multiply_add(constant(p), x, multiply_add(constant(q), y, hn::Mul(constant(r), z)));
  };
  const Float share = hn::Mul(part.length, constant(1.0f / 30.0f));
  const Float weights[3] = {hn::Mul(share, weigh(4.0f, f, 2.0f, m, -1.0f, b)),
                            hn::Mul(share, weigh(2.0f, f, 16.0f, m, 2.0f, b)),
                            hn::Mul(share, weigh(-1.0f, f, 2.0f, m, 4.0f, b))};
  const Float square = hn::Mul(depth, depth);
  const Float ratio = absorbed_ratio(depth);
  const Float series = multiply_add(square, constant(1.0f / 480.0f), constant(1.0f / 12.0f));
  const Float lag = hn::Mul(hn::Mul(square, series), exp_negative(hn::Mul(constant(0.5f), depth)));
  const auto channel = [&](Float c0, Float c1, Float c2, Float so_far) {
    const Float mean = multiply_add(weights[0], c0, multiply_add(weights[1], c1, hn::Mul(weights[2], c2)));
    const Float color = hn::Sub(hn::Mul(mean, ratio), hn::Mul(hn::Sub(c2, c0), lag));
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

  /// Linear pieces that the part of a stretch between two cuts needs for what is bent in it.
  template <class Stretch>
  HWY_INLINE Float count_pieces(const Stretch& stretch, const Cut& begin, const Cut& end, Float transmittance) const {
    Float rate = constant(0.0f);
    const Float part = hn::Sub(end.u, begin.u), square = hn::Mul(part, part);
    for (int axis = 0; axis < kCount; ++axis) {
      const DomainAxis& a = domain_.axes[axis];
      if (a.steepness == 0.0f) continue;
      Float bend = constant(0.0f);
      if (a.source == DomainAxis::Source::kGradient)
        bend = find_bend_of_magnitude(stretch, begin, end);
      else if constexpr (!Stretch::kIsLinear)
        bend = hn::Mul(square, a.source == DomainAxis::Source::kScalar ? stretch.bend() : stretch.other_bend(axis));
      bend = hn::IfThenElseZero(hn::Eq(bend, bend), bend);  // of missing values nothing is drawn
      rate = multiply_add(bend, constant(a.steepness), rate);
    }
    const Float wanted =
        hn::Ceil(hn::Sqrt(hn::Mul(hn::Mul(rate, transmittance), constant(1.0f / domain_.allowed_rate))));
    const Float pieces = hn::Min(hn::Max(wanted, constant(1.0f)), constant(domain_.most_pieces));
    return hn::IfThenElse(hn::Gt(stretch.length, constant(0.0f)), pieces, constant(1.0f));
  }

  /// Adds the piece of a stretch between two cuts; `length` its world length. `moment`: where there is one, what the
  /// piece absorbs times where (as u of the stretch) is added to it.
  template <class Stretch>
  HWY_NOINLINE void integrate_piece(const Stretch& stretch, const Cut& a, const Cut& b, Float length, Accumulated& sum,
                                    Float* moment) const {
    DomainPath<kCount> path;
    Mask active = hn::Gt(length, constant(0.0f));
    for (int axis = 0; axis < kCount; ++axis) {
      const Float front = function_.coordinate(axis, scalar_at(stretch, a, axis));
      const Float back = function_.coordinate(axis, scalar_at(stretch, b, axis));
      // What is missing is transparent.
      const Mask present = hn::And(hn::Eq(front, front), hn::Eq(back, back));
      active = hn::And(active, present);
      path.begin[axis] = hn::IfThenElseZero(present, front);
      path.span[axis] = hn::IfThenElseZero(present, hn::Sub(back, front));
    }
    if (hn::AllFalse(kFloat, active)) return;
    const Float part = hn::Sub(b.u, a.u);
    follow(path, length, active, sum, [&](Float from, Float to, const DomainPart& piece, Float absorbed) {
      if (!moment) return;
      const Float place = multiply_add(multiply_add(piece.centroid(), hn::Sub(to, from), from), part, a.u);
      *moment = multiply_add(absorbed, place, *moment);
    });
  }

 private:
  static constexpr int kCount = Function::kCount;
  /// The colour is not quite linear in the optical depth: by dc tau^2 / 60 at worst.
  static constexpr float kErrorOfSlope = 60.0f;
  /// The series of `composite_part` is good up to this optical depth.
  static constexpr float kDeepest = 1.0f;
  static constexpr float kShortest = 1e-6f;

  template <class Stretch>
  HWY_INLINE Float scalar_at(const Stretch& stretch, const Cut& cut, int axis) const {
    switch (domain_.axes[axis].source) {
      case DomainAxis::Source::kGradient:
        return magnitude_at(effects_, stretch, cut.u);
      case DomainAxis::Source::kOther:
        return stretch.other(axis, cut.u);
      case DomainAxis::Source::kScalar:
        break;
    }
    return cut.scalar;
  }

  /// How far the gradient magnitude strays from its chord: it is convex where gradients are linear.
  template <class Stretch>
  HWY_NOINLINE Float find_bend_of_magnitude(const Stretch& stretch, const Cut& begin, const Cut& end) const {
    const Float half = constant(0.5f);
    const Float chord =
        hn::Mul(half, hn::Add(magnitude_at(effects_, stretch, begin.u), magnitude_at(effects_, stretch, end.u)));
    return hn::AbsDiff(chord, magnitude_at(effects_, stretch, hn::Mul(half, hn::Add(begin.u, end.u))));
  }

  /// Calls `note(from, to, part, absorbed)` for each part that is added.
  template <class Note>
  HWY_INLINE void follow(const DomainPath<kCount>& path, Float length, Mask active, Accumulated& sum,
                         const Note& note) const {
    const Float zero = constant(0.0f), one = constant(1.0f), half = constant(0.5f);
    typename Function::Box box = function_.start(path);
    Float at = zero, step = one;
    do {
      Float borders[kCount], border = one;
      for (int axis = 0; axis < kCount; ++axis) {
        borders[axis] = hn::Max(function_.border(path, box, axis), at);
        border = hn::Min(border, borders[axis]);
      }
      const Float next = hn::Min(border, hn::Add(at, step));
      const typename Function::Corners corners = function_.load(box);
      const DomainPart part{function_.eval(path, corners, at),
                            function_.eval(path, corners, hn::Mul(half, hn::Add(at, next))),
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
      // What comes after a millionth of the light has no colour to add.
      active = hn::And(active, hn::And(hn::Lt(at, one), hn::Gt(sum.transmittance, constant(kLeftOver))));
    } while (!hn::AllFalse(kFloat, active));
  }

  static constexpr float kLeftOver = 1e-6f;

  Function function_;
  const DomainFunction& domain_;
  const Effects& effects_;
  float threshold_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
