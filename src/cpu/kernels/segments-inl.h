// Segments, what is accumulated along a ray, and the control points of the function, evaluated exactly.

#if defined(TETRAVOX_CPU_SEGMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_SEGMENTS_INL
#undef TETRAVOX_CPU_SEGMENTS_INL
#else
#define TETRAVOX_CPU_SEGMENTS_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Premultiplied colour so far and what still comes through.
struct Accumulated {
  Float red, green, blue, transmittance;
};

/// Segments of a vector of rays, in world lengths; a ray that does not take part has length 0.
struct Segments {
  Float scalar_front, scalar_back, length;
};

/// Adds a homogeneous piece: `depth` its optical depth, `emission` colour times depth.
HWY_INLINE void composite_piece(Float depth, const Float emission[3], Float ratio, Accumulated& sum) {
  const Float visible = hn::Mul(sum.transmittance, ratio);
  sum.red = multiply_add(visible, emission[0], sum.red);
  sum.green = multiply_add(visible, emission[1], sum.green);
  sum.blue = multiply_add(visible, emission[2], sum.blue);
  sum.transmittance = hn::Sub(sum.transmittance, hn::Mul(visible, depth));
}

/// Below this transmittance a ray is looked at for early termination.
constexpr float kDim = 1e-4f;

/// Rays of which no 8-bit pixel can change any more: whatever follows adds between nothing and the transmittance to
/// each channel, over any background, with or without alpha.
HWY_INLINE Mask is_settled(const Accumulated& sum) {
  const Mask dim = hn::Lt(sum.transmittance, constant(kDim));
  if (HWY_LIKELY(hn::AllFalse(kFloat, dim))) return dim;
  // Three transmittances bound the channel divided by alpha, too, and rounding.
  const Float reach = hn::Mul(constant(3.0f), sum.transmittance);
  const auto settled = [&](Float channel) {
    const Float low = hn::Floor(multiply_add(hn::Sub(channel, constant(1e-6f)), constant(255.0f), constant(0.5f)));
    const Float high =
        hn::Floor(multiply_add(hn::Add(hn::Add(channel, reach), constant(1e-6f)), constant(255.0f), constant(0.5f)));
    return hn::Eq(low, high);
  };
  return hn::And(dim, hn::And(hn::And(settled(sum.red), settled(sum.green)), settled(sum.blue)));
}

/// Exact evaluation of the control points.
class ControlPoints {
 public:
  explicit ControlPoints(const optics::ControlPointTable& table) : table_(table) {}

  /// The interval that holds `scalar`; a scalar at a control point belongs to the interval that starts there.
  HWY_INLINE Int find_interval(Float scalar) const {
    const float last_bucket = static_cast<float>(table_.first_interval.size() - 1);
    const Float at = hn::Mul(hn::Sub(scalar, constant(table_.first)), constant(table_.buckets_per_scalar));
    const Int bucket = hn::ConvertTo(kInt, hn::Min(hn::Max(at, constant(0.0f)), constant(last_bucket)));
    Int interval = hn::GatherIndex(kInt, table_.first_interval.data(), bucket);
    for (;;) {
      const Mask passed = hn::Le(start_of(hn::Add(interval, hn::Set(kInt, 1))), scalar);
      if (hn::AllFalse(kFloat, passed)) return interval;
      interval = hn::IfThenElse(int_mask(passed), hn::Add(interval, hn::Set(kInt, 1)), interval);
    }
  }
  /// The interval in which a ray sets out from `scalar`: one that falls from a control point starts in the interval
  /// below.
  HWY_INLINE Int find_front_interval(Float scalar, Mask rising) const {
    const Int interval = find_interval(scalar);
    const Mask at_start = hn::AndNot(rising, hn::Eq(start_of(interval), scalar));
    return hn::Max(hn::IfThenElse(int_mask(at_start), hn::Sub(interval, hn::Set(kInt, 1)), interval), hn::Zero(kInt));
  }
  HWY_INLINE Float start_of(Int interval) const { return hn::GatherIndex(kFloat, table_.starts.data(), interval); }

  /// Extinction and colour at `scalar` by the line of `interval`.
  HWY_INLINE Record eval(Int interval, Float scalar) const {
    const Uint index = hn::BitCast(kUint, interval);
    const Record start = load_table_records(table_.densities_front.data()->data(), index);
    const Record slope = load_table_records(table_.slopes.data()->data(), index);
    const Float x = hn::Sub(scalar, hn::GatherIndex(kFloat, table_.references.data(), interval));
    return {hn::Max(multiply_add(slope.x, x, start.x), constant(0.0f)), multiply_add(slope.y, x, start.y),
            multiply_add(slope.z, x, start.z), multiply_add(slope.w, x, start.w)};
  }

 private:
  const optics::ControlPointTable& table_;
};

/// Goes along a segment from control point to control point and calls `composite(front, back, length)` for each piece,
/// on which extinction and colour are linear. A piece is no deeper than `find_deepest(front, goal)` (optical depth).
template <class FindDeepest, class Composite>
HWY_INLINE void for_each_linear_piece(const ControlPoints& points, const Segments& segment, Mask lanes,
                                      const FindDeepest& find_deepest, const Float& transmittance,
                                      const Composite& composite) {
  const Float one = constant(1.0f);
  const Float span = hn::Sub(segment.scalar_back, segment.scalar_front);
  const Mask rising = hn::Ge(span, constant(0.0f));
  const Mask level = hn::Eq(span, constant(0.0f));
  const Float divisor = hn::IfThenElse(level, one, span);
  const Int forward = hn::IfThenElse(int_mask(rising), hn::Set(kInt, 1), hn::Set(kInt, -1));
  const Int border_side = hn::IfThenElse(int_mask(rising), hn::Set(kInt, 1), hn::Zero(kInt));

  Int interval = points.find_front_interval(segment.scalar_front, rising);
  Float t = constant(0.0f), scalar = segment.scalar_front;
  Mask active = hn::And(lanes, hn::Gt(segment.length, constant(0.0f)));
  while (!hn::AllFalse(kFloat, active)) {
    // Aim at the next control point or the end, and no further than is allowed.
    const Float border = points.start_of(hn::Add(interval, border_side));
    const Float border_t = hn::Max(hn::Div(hn::Sub(border, segment.scalar_front), divisor), t);
    const Mask to_end = hn::Or(level, hn::Ge(border_t, one));
    const Float goal_t = hn::IfThenElse(to_end, one, border_t);
    const Float goal = hn::IfThenElse(to_end, segment.scalar_back, border);
    const Record front = points.eval(interval, scalar);
    const Record ahead = points.eval(interval, goal);
    const Float depth = hn::Mul(hn::Max(front.x, ahead.x), segment.length);
    const Float reach = hn::Div(find_deepest(front, ahead), hn::Max(depth, constant(1e-30f)));
    // A step too small for float would never end: then go all the way.
    const Mask arrives = hn::Or(hn::Le(goal_t, hn::Add(t, reach)), hn::Le(hn::Add(t, reach), t));
    const Float next_t = hn::IfThenElse(arrives, goal_t, hn::Add(t, reach));
    const Float next = hn::IfThenElse(arrives, goal, multiply_add(span, next_t, segment.scalar_front));

    composite(front, points.eval(interval, next),
              hn::IfThenElseZero(active, hn::Mul(segment.length, hn::Sub(next_t, t))));
    const Mask done = hn::Or(hn::And(arrives, to_end), hn::Le(transmittance, constant(1e-6f)));
    const Mask crosses = hn::AndNot(to_end, arrives);
    interval = hn::IfThenElse(int_mask(crosses), hn::Add(interval, forward), interval);
    t = next_t;
    scalar = next;
    active = hn::AndNot(done, active);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
