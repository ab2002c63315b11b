// The integrators: a segment (scalar at front and back, length) -> colour and transmittance, a vector of rays at a
// time.

#if defined(TETRAVOX_CPU_INTEGRATORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_INTEGRATORS_INL
#undef TETRAVOX_CPU_INTEGRATORS_INL
#else
#define TETRAVOX_CPU_INTEGRATORS_INL
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

/// Integrals from tables of antiderivatives (src/optics/antiderivative_table.h).
///
/// alpha is exact. The emission is taken as spread like the extinction: C = mean colour * (1 - exp(-tau)). Where the
/// colour changes by dc within the segment that errs by up to dc tau^2 / 12 (first term of the expansion in tau), so
/// the segment is cut into pieces wherever that exceeds the tolerance.
class AntiderivativeIntegrator {
 public:
  /// What is kept of the front: its node and the antiderivatives there.
  struct Front {
    Int node;
    Int sums[4];
  };

  explicit AntiderivativeIntegrator(const IntegratorTables& tables)
      : table_(*tables.antiderivative),
        entries_(reinterpret_cast<const float*>(table_.entries.data())),
        split_threshold_(12.0f * tables.tolerance) {}

  HWY_INLINE Front front_at(Float scalar) const {
    Front front;
    front.node = nearest_node(position(scalar));
    load(front.node, front.sums);
    return front;
  }

  HWY_INLINE void integrate(const Segments& segment, Front& front, Accumulated& sum) const {
    const Float back_position = position(segment.scalar_back);
    const Int back = nearest_node(back_position);
    const Int nodes = hn::Sub(back, front.node);
    const auto flat = hn::Lt(hn::Abs(nodes), hn::Set(kInt, optics::AntiderivativeTable::kFlatNodes + 1));

    // A flat segment reads the density at its middle; any other, the antiderivatives at its back.
    const Int middle = hn::Add(hn::ShiftRight<1>(hn::Add(back, front.node)), hn::Set(kInt, table_.last_node + 1));
    Int sums[4];
    load(hn::IfThenElse(flat, middle, back), sums);
    const Mask flat_lanes = hn::RebindMask(kFloat, flat);
    const Float node_count = hn::ConvertTo(kFloat, hn::IfThenElse(flat, hn::Set(kInt, 1), nodes));
    const Float scale = hn::Div(hn::Mul(segment.length, constant(table_.quantum)), node_count);
    Float integrals[4];
    for (int i = 0; i < 4; ++i) {
      const Float difference = hn::Mul(hn::ConvertTo(kFloat, hn::Sub(sums[i], front.sums[i])), scale);
      const Float density = hn::Mul(hn::BitCast(kFloat, sums[i]), segment.length);
      integrals[i] = hn::IfThenElse(flat_lanes, density, difference);
    }

    // Pick the segments that are thick, or that may change colour too much, or that leave the table.
    const Float depth = integrals[0];
    const Float change = hn::Min(constant(1.0f), hn::Mul(hn::Abs(node_count), constant(table_.largest_color_slope)));
    const Mask thick = hn::Or(hn::Gt(hn::Mul(hn::Mul(depth, depth), change), constant(split_threshold_)),
                              hn::Gt(depth, constant(0.25f)));
    const Mask special = hn::Or(thick, hn::Or(outside(back_position), outside(position(segment.scalar_front))));
    if (HWY_UNLIKELY(!hn::AllFalse(kFloat, special))) {
      Accumulated special_sum = sum;
      integrate_special(segment, front.node, back, special, depth, special_sum);
      composite_piece(depth, integrals + 1, absorbed_ratio_series(depth), sum);
      sum.red = hn::IfThenElse(special, special_sum.red, sum.red);
      sum.green = hn::IfThenElse(special, special_sum.green, sum.green);
      sum.blue = hn::IfThenElse(special, special_sum.blue, sum.blue);
      sum.transmittance = hn::IfThenElse(special, special_sum.transmittance, sum.transmittance);
    } else {
      composite_piece(depth, integrals + 1, absorbed_ratio_series(depth), sum);
    }

    // The front stays where it is while the scalar is flat, so that nothing is lost to rounding.
    front.node = hn::IfThenElse(flat, front.node, back);
    for (int i = 0; i < 4; ++i) front.sums[i] = hn::IfThenElse(flat, front.sums[i], sums[i]);
  }

 private:
  HWY_INLINE Float position(Float scalar) const {
    return hn::Mul(hn::Sub(scalar, constant(table_.first)), constant(table_.nodes_per_scalar));
  }
  HWY_INLINE Float inside(Float at) const {
    return hn::Min(hn::Max(at, constant(0.0f)), constant(static_cast<float>(table_.last_node)));
  }
  HWY_INLINE Int nearest_node(Float at) const { return hn::NearestInt(inside(at)); }
  HWY_INLINE Mask outside(Float at) const {
    return hn::Or(hn::Lt(at, constant(-1.0f)), hn::Gt(at, constant(static_cast<float>(table_.last_node) + 1.0f)));
  }
  HWY_INLINE void load(Int entry, Int sums[4]) const {
    const Record record = load_records(entries_, hn::BitCast(kUint, entry));
    sums[0] = hn::BitCast(kInt, record.x);
    sums[1] = hn::BitCast(kInt, record.y);
    sums[2] = hn::BitCast(kInt, record.z);
    sums[3] = hn::BitCast(kInt, record.w);
  }

  /// A place along the scalar: its node, what lies beyond the table's ends, and the antiderivatives at the node.
  struct Place {
    Float node, below, above;
    Int sums[4];
  };
  HWY_INLINE Place place_at(Float at, Int node) const {
    Place place;
    place.node = hn::ConvertTo(kFloat, node);
    place.below = hn::Min(at, constant(0.0f));
    place.above = hn::Max(hn::Sub(at, constant(static_cast<float>(table_.last_node))), constant(0.0f));
    load(node, place.sums);
    return place;
  }

  /// Optical depth and emission of the piece from `a` to `b` of the given length.
  HWY_INLINE void integrate_piece(const Place& a, const Place& b, Float length, Float integrals[4]) const {
    const Float below = hn::Sub(b.below, a.below), above = hn::Sub(b.above, a.above);
    const Float covered = hn::Sub(b.node, a.node);
    const Float width = hn::Add(covered, hn::Add(below, above));
    const Mask flat = hn::Le(hn::Abs(width), constant(static_cast<float>(optics::AntiderivativeTable::kFlatNodes)));
    const Float inverse = hn::Div(length, hn::IfThenElse(flat, constant(1.0f), width));
    const Int middle = hn::ConvertTo(kInt, hn::Mul(constant(0.5f), hn::Add(a.node, b.node)));
    Int densities[4];
    load(hn::Add(middle, hn::Set(kInt, table_.last_node + 1)), densities);
    const Mask under = hn::Lt(hn::Add(a.below, b.below), constant(-2.0f));
    const Mask over = hn::Gt(hn::Add(a.above, b.above), constant(2.0f));
    for (int i = 0; i < 4; ++i) {
      const Float low = constant(table_.density_below[i]), high = constant(table_.density_above[i]);
      Float total = hn::Mul(hn::ConvertTo(kFloat, hn::Sub(b.sums[i], a.sums[i])), constant(table_.quantum));
      total = multiply_add(low, below, total);
      total = multiply_add(high, above, total);
      const Float density = hn::IfThenElse(under, low, hn::IfThenElse(over, high, hn::BitCast(kFloat, densities[i])));
      integrals[i] = hn::IfThenElse(flat, hn::Mul(density, length), hn::Mul(total, inverse));
    }
  }

  /// Cuts the segments of `lanes` into equal pieces, as many as the tolerance asks for, and composites them.
  HWY_NOINLINE void integrate_special(const Segments& segment, Int front, Int back, Mask lanes, Float depth,
                                      Accumulated& sum) const {
    const Float length = hn::IfThenElseZero(lanes, segment.length);
    const Float front_position = position(segment.scalar_front);
    const Float span = hn::Sub(position(segment.scalar_back), front_position);
    const Float start_position = hn::IfThenElse(outside(front_position), front_position, hn::ConvertTo(kFloat, front));
    const Float stop_position = hn::Add(front_position, span);

    // Pieces: dc (tau / n)^2 / 12 <= tolerance for the piece in which the colour may change at once.
    const float* variation = table_.color_variation.data();
    const Float change =
        hn::Min(constant(1.0f),
                hn::Abs(hn::Sub(hn::GatherIndex(kFloat, variation, back), hn::GatherIndex(kFloat, variation, front))));
    Float wanted = hn::Mul(depth, hn::Sqrt(hn::Div(change, constant(split_threshold_))));
    wanted = hn::Min(wanted, hn::Max(hn::Abs(hn::ConvertTo(kFloat, hn::Sub(back, front))), constant(1.0f)));
    wanted = hn::IfThenElse(hn::Gt(wanted, constant(1.0f)), wanted, constant(1.0f));
    const Float pieces = hn::IfThenElse(lanes, hn::Ceil(hn::Min(wanted, constant(4096.0f))), constant(1.0f));
    const Float share = hn::Div(constant(1.0f), pieces);
    const Float piece_length = hn::Mul(length, share);
    const Float step = hn::Mul(hn::Sub(stop_position, start_position), share);

    Place at = place_at(start_position, front);
    Mask active = lanes;
    for (Float k = constant(1.0f); !hn::AllFalse(kFloat, active); k = hn::Add(k, constant(1.0f))) {
      const Mask last = hn::Ge(k, pieces);
      const Float next_position = hn::IfThenElse(last, stop_position, multiply_add(step, k, start_position));
      const Place next = place_at(next_position, nearest_node(next_position));
      Float integrals[4];
      integrate_piece(at, next, hn::IfThenElseZero(active, piece_length), integrals);
      composite_piece(integrals[0], integrals + 1, absorbed_ratio(integrals[0]), sum);
      at = next;
      // What comes after a millionth of the light has no colour to add.
      active = hn::AndNot(last, hn::And(active, hn::Gt(sum.transmittance, constant(1e-6f))));
    }
  }

  const optics::AntiderivativeTable& table_;
  const float* entries_;
  float split_threshold_;
};

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
  HWY_INLINE Float start_of(Int interval) const { return hn::GatherIndex(kFloat, table_.starts.data(), interval); }
  HWY_INLINE Int last_interval() const { return hn::Set(kInt, table_.interval_count - 1); }
  int interval_count() const { return table_.interval_count; }

  /// Extinction and colour at `scalar` by the line of `interval`.
  HWY_INLINE Record eval(Int interval, Float scalar) const {
    const Uint index = hn::BitCast(kUint, interval);
    const Record start = load_records(table_.densities_front.data()->data(), index);
    const Record slope = load_records(table_.slopes.data()->data(), index);
    const Float x = hn::Sub(scalar, hn::GatherIndex(kFloat, table_.references.data(), interval));
    return {hn::Max(multiply_add(slope.x, x, start.x), constant(0.0f)), multiply_add(slope.y, x, start.y),
            multiply_add(slope.z, x, start.z), multiply_add(slope.w, x, start.w)};
  }

 private:
  const optics::ControlPointTable& table_;
};

/// Adds a piece of constant colour.
HWY_INLINE void composite_uniform(const Record& optics, Float length, Accumulated& sum) {
  const Float depth = hn::Mul(optics.x, length);
  const Float emission[3] = {hn::Mul(depth, optics.y), hn::Mul(depth, optics.z), hn::Mul(depth, optics.w)};
  composite_piece(depth, emission, absorbed_ratio(depth), sum);
}

/// Partial pre-integration: exact for piecewise linear functions (Moreland and Angel 2004), the control points met in
/// order along the segment (Espinha and Celes 2005).
class PartialIntegrator {
 public:
  struct Front {};

  explicit PartialIntegrator(const IntegratorTables& tables)
      : points_(*tables.control_points), absorbed_(tables.transparency->absorbed.data()) {}

  HWY_INLINE Front front_at(Float) const { return {}; }

  HWY_INLINE void integrate(const Segments& segment, Front&, Accumulated& sum) const {
    const Float one = constant(1.0f);
    const Float span = hn::Sub(segment.scalar_back, segment.scalar_front);
    const Mask rising = hn::Ge(span, constant(0.0f));
    const Mask level = hn::Eq(span, constant(0.0f));
    const Float divisor = hn::IfThenElse(level, one, span);
    const Int forward = hn::IfThenElse(int_mask(rising), hn::Set(kInt, 1), hn::Set(kInt, -1));
    const Int border_side = hn::IfThenElse(int_mask(rising), hn::Set(kInt, 1), hn::Zero(kInt));

    Int interval = find_front_interval(segment.scalar_front, rising);
    Float t = constant(0.0f), scalar = segment.scalar_front;
    Mask active = hn::Gt(segment.length, constant(0.0f));
    while (!hn::AllFalse(kFloat, active)) {
      // Aim at the next control point or the end, and no further than the optical depth that the table is good for.
      const Float border = points_.start_of(hn::Add(interval, border_side));
      const Float border_t = hn::Max(hn::Div(hn::Sub(border, segment.scalar_front), divisor), t);
      const Mask to_end = hn::Or(level, hn::Ge(border_t, one));
      const Float goal_t = hn::IfThenElse(to_end, one, border_t);
      const Float goal = hn::IfThenElse(to_end, segment.scalar_back, border);
      const Record front = points_.eval(interval, scalar);
      const Float steepest = hn::Max(front.x, points_.eval(interval, goal).x);
      const Float reach = hn::Div(constant(kDeepest), hn::Max(hn::Mul(steepest, segment.length), constant(1e-30f)));
      const Mask arrives = hn::Le(goal_t, hn::Add(t, reach));
      const Float next_t = hn::IfThenElse(arrives, goal_t, hn::Add(t, reach));
      const Float next = hn::IfThenElse(arrives, goal, multiply_add(span, next_t, segment.scalar_front));

      const Float length = hn::IfThenElseZero(active, hn::Mul(segment.length, hn::Sub(next_t, t)));
      composite_linear(front, points_.eval(interval, next), length, sum);
      const Mask done = hn::Or(hn::And(arrives, to_end), hn::Le(sum.transmittance, constant(1e-6f)));
      const Mask crosses = hn::AndNot(to_end, arrives);
      interval = hn::IfThenElse(int_mask(crosses), hn::Add(interval, forward), interval);
      t = next_t;
      scalar = next;
      active = hn::AndNot(done, active);
    }
  }

 private:
  static constexpr float kDeepest = 8.0f;

  /// A ray that falls from a control point starts in the interval below it.
  HWY_INLINE Int find_front_interval(Float scalar, Mask rising) const {
    const Int interval = points_.find_interval(scalar);
    const Mask at_start = hn::AndNot(rising, hn::Eq(points_.start_of(interval), scalar));
    return hn::Max(hn::IfThenElse(int_mask(at_start), hn::Sub(interval, hn::Set(kInt, 1)), interval), hn::Zero(kInt));
  }

  /// C = c0 (1 - psi) + c1 (psi - exp(-tau)), written with 1 - psi and alpha so that nothing cancels.
  HWY_INLINE void composite_linear(const Record& a, const Record& b, Float length, Accumulated& sum) const {
    const Float depth_front = hn::Mul(a.x, length), depth_back = hn::Mul(b.x, length);
    const Float depth = hn::Mul(constant(0.5f), hn::Add(depth_front, depth_back));
    const Float alpha = hn::Mul(depth, absorbed_ratio(depth));
    const Float absorbed = look_up_absorbed(depth_front, depth_back);
    const auto channel = [&](Float c0, Float c1, Float so_far) {
      const Float color = multiply_add(hn::Sub(c0, c1), absorbed, hn::Mul(c1, alpha));
      return multiply_add(sum.transmittance, color, so_far);
    };
    sum.red = channel(a.y, b.y, sum.red);
    sum.green = channel(a.z, b.z, sum.green);
    sum.blue = channel(a.w, b.w, sum.blue);
    sum.transmittance = hn::Sub(sum.transmittance, hn::Mul(sum.transmittance, alpha));
  }

  HWY_INLINE Float look_up_absorbed(Float d0, Float d1) const {
    constexpr int kSize = optics::TransparencyTable::kSize;
    const Float one = constant(1.0f), size = constant(static_cast<float>(kSize));
    const Float row = hn::Mul(size, hn::Div(d0, hn::Add(d0, one)));
    const Float column = hn::Mul(size, hn::Div(d1, hn::Add(d1, one)));
    const Int row_node = hn::Min(hn::ConvertTo(kInt, row), hn::Set(kInt, kSize - 1));
    const Int column_node = hn::Min(hn::ConvertTo(kInt, column), hn::Set(kInt, kSize - 1));
    const Float v = hn::Sub(row, hn::ConvertTo(kFloat, row_node));
    const Float u = hn::Sub(column, hn::ConvertTo(kFloat, column_node));
    const Int node = hn::Add(hn::Mul(row_node, hn::Set(kInt, kSize + 1)), column_node);
    const auto at = [&](int offset) {
      return hn::GatherIndex(kFloat, absorbed_, hn::Add(node, hn::Set(kInt, offset)));
    };
    const Float low = multiply_add(u, hn::Sub(at(1), at(0)), at(0));
    const Float high = multiply_add(u, hn::Sub(at(kSize + 2), at(kSize + 1)), at(kSize + 1));
    return multiply_add(v, hn::Sub(high, low), low);
  }

  ControlPoints points_;
  const float* absorbed_;
};

/// Post-classification: point samples in the middles of equal pieces.
class PostIntegrator {
 public:
  struct Front {};

  explicit PostIntegrator(const IntegratorTables& tables) : points_(*tables.control_points), samples_(tables.samples) {}

  HWY_INLINE Front front_at(Float) const { return {}; }

  HWY_INLINE void integrate(const Segments& segment, Front&, Accumulated& sum) const {
    const float share = 1.0f / static_cast<float>(samples_);
    const Float length = hn::Mul(segment.length, constant(share));
    const Float span = hn::Sub(segment.scalar_back, segment.scalar_front);
    for (int i = 0; i < samples_; ++i) {
      const float t = (static_cast<float>(i) + 0.5f) * share;
      const Float scalar = multiply_add(span, constant(t), segment.scalar_front);
      composite_uniform(points_.eval(points_.find_interval(scalar), scalar), length, sum);
    }
  }

 private:
  ControlPoints points_;
  int samples_;
};

/// Cell data: one value a segment, exact.
class CellIntegrator {
 public:
  struct Front {};

  explicit CellIntegrator(const IntegratorTables& tables) : points_(*tables.control_points) {}

  HWY_INLINE Front front_at(Float) const { return {}; }

  HWY_INLINE void integrate(const Segments& segment, Front&, Accumulated& sum) const {
    const Float scalar = segment.scalar_back;
    composite_uniform(points_.eval(points_.find_interval(scalar), scalar), segment.length, sum);
  }

 private:
  ControlPoints points_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
