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
    const Record start = load_records(table_.densities_front.data()->data(), index);
    const Record slope = load_records(table_.slopes.data()->data(), index);
    const Float x = hn::Sub(scalar, hn::GatherIndex(kFloat, table_.references.data(), interval));
    return {hn::Max(multiply_add(slope.x, x, start.x), constant(0.0f)), multiply_add(slope.y, x, start.y),
            multiply_add(slope.z, x, start.z), multiply_add(slope.w, x, start.w)};
  }

 private:
  const optics::ControlPointTable& table_;
};

/// Goes along a segment from control point to control point and calls `composite(front, back, length)` for each piece,
/// on which extinction and colour are linear. A piece is no deeper than `deepest` (optical depth).
template <class Composite>
HWY_INLINE void for_each_linear_piece(const ControlPoints& points, const Segments& segment, Mask lanes, float deepest,
                                      const Float& transmittance, const Composite& composite) {
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
    // Aim at the next control point or the end, and no further than `deepest`.
    const Float border = points.start_of(hn::Add(interval, border_side));
    const Float border_t = hn::Max(hn::Div(hn::Sub(border, segment.scalar_front), divisor), t);
    const Mask to_end = hn::Or(level, hn::Ge(border_t, one));
    const Float goal_t = hn::IfThenElse(to_end, one, border_t);
    const Float goal = hn::IfThenElse(to_end, segment.scalar_back, border);
    const Record front = points.eval(interval, scalar);
    const Float steepest = hn::Max(front.x, points.eval(interval, goal).x);
    const Float reach = hn::Div(constant(deepest), hn::Max(hn::Mul(steepest, segment.length), constant(1e-30f)));
    const Mask arrives = hn::Le(goal_t, hn::Add(t, reach));
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

/// Adds a piece of constant colour.
HWY_INLINE void composite_uniform(const Record& optics, Float length, Accumulated& sum) {
  const Float depth = hn::Mul(optics.x, length);
  const Float emission[3] = {hn::Mul(depth, optics.y), hn::Mul(depth, optics.z), hn::Mul(depth, optics.w)};
  composite_piece(depth, emission, absorbed_ratio(depth), sum);
}

/// Integrals from tables of antiderivatives (src/optics/antiderivative_table.h).
///
/// alpha is exact. The emission is taken as spread like the extinction: C = mean colour * (1 - exp(-tau)). Where the
/// colour changes by dc within the segment that errs by up to dc tau^2 / 12 (first term of the expansion in tau), so
/// the segment is cut into pieces wherever that exceeds the tolerance. Where a segment meets a step of the function,
/// which no table of nodes can place exactly, it is integrated from control point to control point.
class AntiderivativeIntegrator {
 public:
  /// The function at a scalar: antiderivatives in fixed point, densities rho, rho * colour.
  struct Point {
    Float position;  // in nodes
    Int sums[4];
    Float densities[4];
  };
  using Front = Point;

  explicit AntiderivativeIntegrator(const IntegratorTables& tables)
      : table_(*tables.antiderivative),
        entries_(table_.entries.data()),
        points_(*tables.control_points),
        split_threshold_(12.0f * tables.tolerance) {}

  HWY_INLINE Front front_at(Float scalar) const { return point_at(position(scalar)); }

  HWY_INLINE void integrate(const Segments& segment, Front& front, Accumulated& sum) const {
    const Point back = point_at(position(segment.scalar_back));
    Float integrals[4];
    integrate_between(front, back, segment.length, integrals);

    // Pick the segments that are thick, or that may change colour too much, or that leave the table, or meet a step.
    const Float depth = integrals[0];
    const Float nodes = hn::Abs(hn::Sub(back.position, front.position));
    const Float change = hn::Min(constant(1.0f), hn::Mul(nodes, constant(table_.largest_color_slope)));
    Mask special = hn::Or(hn::Gt(hn::Mul(hn::Mul(depth, depth), change), constant(split_threshold_)),
                          hn::Gt(depth, constant(0.25f)));
    special = hn::Or(special, hn::Or(outside(back.position), outside(front.position)));
    Mask stepped = hn::FirstN(kFloat, 0);
    if (table_.has_steps) {
      stepped = meets_step(front.position, back.position);
      special = hn::Or(special, stepped);
    }
    if (HWY_UNLIKELY(!hn::AllFalse(kFloat, special))) {
      Accumulated other = sum;
      composite_piece(depth, integrals + 1, absorbed_ratio_series(depth), sum);
      if (!hn::AllFalse(kFloat, stepped)) integrate_exactly(segment, stepped, other);
      integrate_pieces(segment.length, front, back, hn::AndNot(stepped, special), depth, other);
      sum.red = hn::IfThenElse(special, other.red, sum.red);
      sum.green = hn::IfThenElse(special, other.green, sum.green);
      sum.blue = hn::IfThenElse(special, other.blue, sum.blue);
      sum.transmittance = hn::IfThenElse(special, other.transmittance, sum.transmittance);
    } else {
      composite_piece(depth, integrals + 1, absorbed_ratio_series(depth), sum);
    }
    front = back;
  }

 private:
  HWY_INLINE Float position(Float scalar) const {
    return hn::Mul(hn::Sub(scalar, constant(table_.first)), constant(table_.nodes_per_scalar));
  }
  HWY_INLINE Float last_position() const { return constant(static_cast<float>(table_.last_node)); }
  HWY_INLINE Float inside(Float at) const { return hn::Min(hn::Max(at, constant(0.0f)), last_position()); }
  HWY_INLINE Mask outside(Float at) const { return hn::Ne(at, inside(at)); }

  HWY_INLINE Point point_at(Float at) const {
    const Float clamped = inside(at);
    const Int node = hn::Min(hn::ConvertTo(kInt, clamped), hn::Set(kInt, table_.last_node - 1));
    const Float f = hn::Sub(clamped, hn::ConvertTo(kFloat, node));
    const Float half_f = hn::Mul(constant(0.5f), f);
    Record sums, low, high;
    load_neighbours(entries_, hn::BitCast(kUint, node), sums, low, high);
    const Float scaled = hn::Mul(f, constant(table_.units_per_density));
    Point point;
    point.position = at;
    const auto channel = [&](int i, Float base, Float d0, Float d1) {
      const Float slope = hn::Sub(d1, d0);
      const Float mean = multiply_add(half_f, slope, d0);
      point.sums[i] = hn::Add(hn::BitCast(kInt, base), hn::NearestInt(hn::Mul(scaled, mean)));
      point.densities[i] = multiply_add(f, slope, d0);
    };
    channel(0, sums.x, low.x, high.x);
    channel(1, sums.y, low.y, high.y);
    channel(2, sums.z, low.z, high.z);
    channel(3, sums.w, low.w, high.w);
    return point;
  }

  /// Optical depth and emission between two points inside the table.
  HWY_INLINE void integrate_between(const Point& a, const Point& b, Float length, Float integrals[4]) const {
    const Float nodes = hn::Sub(b.position, a.position);
    const Mask flat = hn::Lt(hn::Abs(nodes), constant(1.0f));
    const Float scale =
        hn::Div(hn::Mul(length, constant(table_.density_per_unit)), hn::IfThenElse(flat, constant(1.0f), nodes));
    const Float half = hn::Mul(length, constant(0.5f));
    for (int i = 0; i < 4; ++i) {
      const Float difference = hn::Mul(hn::ConvertTo(kFloat, hn::Sub(b.sums[i], a.sums[i])), scale);
      integrals[i] = hn::IfThenElse(flat, hn::Mul(hn::Add(a.densities[i], b.densities[i]), half), difference);
    }
  }

  /// The same where a point may lie beyond the table's ends: there the function is constant.
  HWY_INLINE void integrate_anywhere(const Point& a, const Point& b, Float length, Float integrals[4]) const {
    const auto below = [&](Float at) { return hn::Min(at, constant(0.0f)); };
    const auto above = [&](Float at) { return hn::Max(hn::Sub(at, last_position()), constant(0.0f)); };
    const Float below_nodes = hn::Sub(below(b.position), below(a.position));
    const Float above_nodes = hn::Sub(above(b.position), above(a.position));
    const Float nodes = hn::Sub(b.position, a.position);
    const Mask flat = hn::Lt(hn::Abs(nodes), constant(1.0f));
    const Float scale = hn::Div(length, hn::IfThenElse(flat, constant(1.0f), nodes));
    for (int i = 0; i < 4; ++i) {
      const Float low = constant(table_.density_below[i]), high = constant(table_.density_above[i]);
      const auto density = [&](const Point& p) {
        const Mask under = hn::Lt(p.position, constant(0.0f)), over = hn::Gt(p.position, last_position());
        return hn::IfThenElse(under, low, hn::IfThenElse(over, high, p.densities[i]));
      };
      Float total = hn::Mul(hn::ConvertTo(kFloat, hn::Sub(b.sums[i], a.sums[i])), constant(table_.density_per_unit));
      total = multiply_add(low, below_nodes, total);
      total = multiply_add(high, above_nodes, total);
      const Float mean = hn::Mul(constant(0.5f), hn::Add(density(a), density(b)));
      integrals[i] = hn::IfThenElse(flat, hn::Mul(mean, length), hn::Mul(total, scale));
    }
  }

  HWY_INLINE Int node_at(Float at) const { return hn::ConvertTo(kInt, inside(at)); }

  /// Whether a step of the function lies between the two positions, or within two nodes of either.
  HWY_INLINE Mask meets_step(Float a, Float b) const {
    const std::int32_t* steps = table_.steps_before.data();
    const Int low = node_at(hn::Sub(hn::Min(a, b), constant(2.0f)));
    const Int high = hn::Min(hn::Add(node_at(hn::Add(hn::Max(a, b), constant(2.0f))), hn::Set(kInt, 1)),
                             hn::Set(kInt, table_.last_node));
    return hn::RebindMask(kFloat, hn::Ne(hn::GatherIndex(kInt, steps, low), hn::GatherIndex(kInt, steps, high)));
  }

  /// Cuts the segments of `lanes` into equal pieces, as many as the tolerance asks for, and composites them.
  HWY_NOINLINE void integrate_pieces(Float length, const Point& front, const Point& back, Mask lanes, Float depth,
                                     Accumulated& sum) const {
    // Pieces: dc (tau / n)^2 / 12 <= tolerance for the piece in which the colour may change at once.
    const float* variation = table_.color_variation.data();
    const Float change =
        hn::Min(constant(1.0f), hn::Abs(hn::Sub(hn::GatherIndex(kFloat, variation, node_at(back.position)),
                                                hn::GatherIndex(kFloat, variation, node_at(front.position)))));
    const Float span = hn::Sub(back.position, front.position);
    Float wanted = hn::Mul(depth, hn::Sqrt(hn::Div(change, constant(split_threshold_))));
    wanted = hn::IfThenElse(hn::Gt(wanted, constant(1.0f)), wanted, constant(1.0f));
    const Float pieces = hn::IfThenElse(lanes, hn::Ceil(hn::Min(wanted, constant(4096.0f))), constant(1.0f));
    const Float share = hn::Div(constant(1.0f), pieces);
    const Float piece_length = hn::Mul(length, share);
    const Float step = hn::Mul(span, share);

    Point at = front;
    Mask active = lanes;
    for (Float k = constant(1.0f); !hn::AllFalse(kFloat, active); k = hn::Add(k, constant(1.0f))) {
      const Mask last = hn::Ge(k, pieces);
      const Point next = point_at(hn::IfThenElse(last, back.position, multiply_add(step, k, front.position)));
      Float integrals[4];
      integrate_anywhere(at, next, hn::IfThenElseZero(active, piece_length), integrals);
      composite_piece(integrals[0], integrals + 1, absorbed_ratio(integrals[0]), sum);
      at = next;
      // What comes after a millionth of the light has no colour to add.
      active = hn::AndNot(last, hn::And(active, hn::Gt(sum.transmittance, constant(1e-6f))));
    }
  }

  /// From control point to control point, in pieces so thin that self-attenuation is within the tolerance.
  HWY_NOINLINE void integrate_exactly(const Segments& segment, Mask lanes, Accumulated& sum) const {
    const float deepest = std::sqrt(split_threshold_);
    for_each_linear_piece(points_, segment, lanes, deepest, sum.transmittance,
                          [&](const Record& a, const Record& b, Float length) {
                            const Float depth = hn::Mul(hn::Mul(constant(0.5f), hn::Add(a.x, b.x)), length);
                            const auto emission = [&](Float c0, Float c1) {
                              // Integral of (c0 + dc t)(rho0 + drho t) over t in [0, 1].
                              const Float front = multiply_add(hn::Add(a.x, a.x), c0, hn::Mul(a.x, c1));
                              const Float back = multiply_add(hn::Add(b.x, b.x), c1, hn::Mul(b.x, c0));
                              return hn::Mul(hn::Mul(hn::Add(front, back), length), constant(1.0f / 6.0f));
                            };
                            const Float emissions[3] = {emission(a.y, b.y), emission(a.z, b.z), emission(a.w, b.w)};
                            composite_piece(depth, emissions, absorbed_ratio(depth), sum);
                          });
  }

  const optics::AntiderivativeTable& table_;
  const optics::AntiderivativeTable::Node* entries_;
  ControlPoints points_;
  float split_threshold_;
};

/// Partial pre-integration: exact for piecewise linear functions (Moreland and Angel 2004), the control points met in
/// order along the segment (Espinha and Celes 2005).
class PartialIntegrator {
 public:
  struct Front {};

  explicit PartialIntegrator(const IntegratorTables& tables)
      : points_(*tables.control_points), absorbed_(tables.transparency->absorbed.data()) {}

  HWY_INLINE Front front_at(Float) const { return {}; }

  HWY_INLINE void integrate(const Segments& segment, Front&, Accumulated& sum) const {
    for_each_linear_piece(points_, segment, hn::Gt(segment.length, constant(0.0f)), kDeepest, sum.transmittance,
                          [&](const Record& a, const Record& b, Float length) { composite_linear(a, b, length, sum); });
  }

 private:
  /// The table of psi is fine up to this optical depth.
  static constexpr float kDeepest = 8.0f;

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
