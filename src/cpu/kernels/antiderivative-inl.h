// The default integrator: differences of antiderivatives.

#if defined(TETRAVOX_CPU_ANTIDERIVATIVE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_ANTIDERIVATIVE_INL
#undef TETRAVOX_CPU_ANTIDERIVATIVE_INL
#else
#define TETRAVOX_CPU_ANTIDERIVATIVE_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Integrals from tables of antiderivatives (src/optics/antiderivative_table.h).
///
/// alpha is exact. The emission is taken as spread like the extinction: C = mean colour * (1 - exp(-tau)). Where the
/// colour changes by dc within the segment that errs by up to dc tau^2 / 12 (first term of the expansion in tau), so
/// the segment is cut into pieces wherever that exceeds the tolerance. Where a segment ends at a step of the function,
/// or in a feature finer than the table's nodes, or passes one and is to be cut, it is integrated from control point to
/// control point.
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
        split_threshold_(12.0f * tables.tolerance),
        covers_data_(tables.antiderivative->covers_data && !tables.may_overshoot) {}

  HWY_INLINE Front front_at(Float scalar) const { return point_at(position(scalar)); }
  static HWY_INLINE void replace_front(Mask mask, const Front& from, Front& to) {
    to.position = hn::IfThenElse(mask, from.position, to.position);
    for (int i = 0; i < 4; ++i) {
      to.sums[i] = hn::IfThenElse(int_mask(mask), from.sums[i], to.sums[i]);
      to.densities[i] = hn::IfThenElse(mask, from.densities[i], to.densities[i]);
    }
  }

  /// Vector by vector: a structure of this size would go through a call of memcpy, whose wider loads wait for what has
  /// just been stored.
  static HWY_INLINE void move_front(const Front& from, Front& to) {
    to.position = from.position;
    to.sums[0] = from.sums[0];
    to.sums[1] = from.sums[1];
    to.sums[2] = from.sums[2];
    to.sums[3] = from.sums[3];
    to.densities[0] = from.densities[0];
    to.densities[1] = from.densities[1];
    to.densities[2] = from.densities[2];
    to.densities[3] = from.densities[3];
  }

  HWY_INLINE void integrate(const Segments& segment, Front& front, Accumulated& sum) const {
    const Point back = point_at(position(segment.scalar_back));
    Float integrals[4];
    integrate_between(front, back, segment.length, integrals);
    Mask coarse = hn::FirstN(kFloat, 0);
    if (table_.has_coarse) coarse = hn::Or(is_coarse(front.position), is_coarse(back.position));
    const Float nodes = hn::Abs(hn::Sub(back.position, front.position));
    const Mask doubtful = hn::Or(may_err(integrals[0], nodes, sum), is_beyond(segment));
    if (HWY_LIKELY(hn::AllFalse(kFloat, hn::Or(doubtful, coarse))))
      composite_piece(integrals[0], integrals + 1, absorbed_ratio_series(integrals[0]), sum);
    else
      integrate_doubtful(segment, front, back, integrals, doubtful, coarse, sum);
    move_front(back, front);
  }

  // ---- for the gentle variant below ----

  /// Replaces the integrals of the segments in `lanes`, which are too flat for a difference of sums: densities at their
  /// middle.
  HWY_NOINLINE void integrate_flat(Float middle, Float length, Mask lanes, Float integrals[4]) const {
    const Float clamped = inside(middle);
    const Float low_node = hn::Min(hn::Floor(clamped), hn::Sub(last_position(), constant(1.0f)));
    const Int node = round_small(low_node);
    const Float f = hn::Sub(clamped, low_node);
    const Uint record = hn::BitCast(kUint, hn::Add(node, node));
    const Record low = load_table_records(entries_->densities.data(), record);
    const Record high = load_table_records((entries_ + 1)->densities.data(), record);
    const auto replace = [&](int i, Float a, Float b) {
      const Float density = multiply_add(f, hn::Sub(b, a), a);
      integrals[i] = hn::IfThenElse(lanes, hn::Mul(density, length), integrals[i]);
    };
    replace(0, low.x, high.x);
    replace(1, low.y, high.y);
    replace(2, low.z, high.z);
    replace(3, low.w, high.w);
  }

  /// Segments that are thick, or that may change colour too much: a first guess, by the steepest colour of all.
  HWY_INLINE Mask may_err(Float depth, Float nodes, const Accumulated& sum) const {
    const Float change = hn::Min(constant(1.0f), hn::Mul(nodes, constant(table_.largest_color_slope)));
    const Float error = hn::Mul(hn::Mul(hn::Mul(depth, depth), change), sum.transmittance);
    return hn::Or(hn::Gt(error, constant(split_threshold_)), hn::Gt(depth, constant(0.25f)));
  }
  /// Segments of which an end lies beyond the table, where data may.
  HWY_INLINE Mask is_beyond(const Segments& segment) const {
    if (HWY_LIKELY(covers_data_)) return hn::FirstN(kFloat, 0);
    return hn::Or(outside(position(segment.scalar_front)), outside(position(segment.scalar_back)));
  }

  /// Composites segments some of which need more than the mean: by the colours that they really pass, and in pieces
  /// where these differ too much, or where the table does not serve (`coarse`, and beyond its ends).
  HWY_NOINLINE void integrate_doubtful(const Segments& segment, const Point& front, const Point& back,
                                       const Float integrals[4], Mask doubtful, Mask coarse, Accumulated& sum) const {
    const Float depth = integrals[0];
    const Float change =
        hn::Min(constant(1.0f), hn::AbsDiff(variation_at(back.position), variation_at(front.position)));
    const Float error = hn::Mul(hn::Mul(hn::Mul(depth, depth), change), sum.transmittance);
    // Only what was doubtful by itself: a ray must not depend on its neighbours.
    Mask special = hn::And(doubtful, hn::Or(hn::Gt(error, constant(split_threshold_)), is_beyond(segment)));
    // What is to be cut into pieces must not be finer than the table, either.
    if (table_.has_coarse) {
      coarse = hn::Or(coarse, hn::And(special, passes_coarse(front.position, back.position)));
      special = hn::Or(special, coarse);
    }
    Accumulated other = sum;
    composite_piece(depth, integrals + 1, absorbed_ratio(depth), sum);
    if (hn::AllFalse(kFloat, special)) return;
    if (!hn::AllFalse(kFloat, coarse)) integrate_exactly(segment, coarse, other);
    const Mask pieces = hn::AndNot(coarse, special);
    if (!hn::AllFalse(kFloat, pieces)) integrate_pieces(segment.length, front, back, pieces, other);
    sum.red = hn::IfThenElse(special, other.red, sum.red);
    sum.green = hn::IfThenElse(special, other.green, sum.green);
    sum.blue = hn::IfThenElse(special, other.blue, sum.blue);
    sum.transmittance = hn::IfThenElse(special, other.transmittance, sum.transmittance);
  }
  HWY_INLINE Float position(Float scalar) const {
    return hn::Mul(hn::Sub(scalar, constant(table_.first)), constant(table_.nodes_per_scalar));
  }
  HWY_INLINE Float last_position() const { return constant(static_cast<float>(table_.last_node)); }
  HWY_INLINE Float inside(Float at) const { return hn::Min(hn::Max(at, constant(0.0f)), last_position()); }
  HWY_INLINE Mask outside(Float at) const {
    return hn::Or(hn::Lt(at, constant(-0.5f)), hn::Gt(at, hn::Add(last_position(), constant(0.5f))));
  }

 private:
  HWY_INLINE Point point_at(Float at) const {
    const Float clamped = inside(at);
    const Float low_node = hn::Min(hn::Floor(clamped), hn::Sub(last_position(), constant(1.0f)));
    const Int node = round_small(low_node);
    const Float f = hn::Sub(clamped, low_node);
    const Float half_f = hn::Mul(constant(0.5f), f);
    // A node's densities follow its sums; those of the next node end the line from it.
    const Uint record = hn::BitCast(kUint, hn::Add(node, node));
    const Record sums = load_table_records(entries_->sums.data(), record);
    const Record low = load_table_records(entries_->densities.data(), record);
    const Record high = load_table_records((entries_ + 1)->densities.data(), record);
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

  HWY_INLINE Int node_at(Float at) const { return round_small(hn::Floor(inside(at))); }

  /// Whether the table is too coarse at a position: a segment that ends there is left to the control points. One that
  /// only passes over such a place is not: the antiderivatives are exact at all nodes.
  HWY_INLINE Mask is_coarse(Float at) const {
    return hn::RebindMask(kFloat, hn::Ne(hn::GatherIndex(kInt, table_.is_coarse.data(), node_at(at)), hn::Zero(kInt)));
  }

  /// Whether the table is too coarse anywhere between two positions.
  HWY_INLINE Mask passes_coarse(Float a, Float b) const {
    const std::int32_t* before = table_.coarse_before.data();
    const Int low = node_at(hn::Min(a, b)), high = hn::Add(node_at(hn::Max(a, b)), hn::Set(kInt, 1));
    return hn::RebindMask(kFloat, hn::Ne(hn::GatherIndex(kInt, before, low), hn::GatherIndex(kInt, before, high)));
  }

  /// Colour variation up to a position.
  HWY_INLINE Float variation_at(Float at) const {
    return hn::GatherIndex(kFloat, table_.color_variation.data(), node_at(hn::Add(at, constant(0.5f))));
  }

  /// Composites the segments of `lanes` in pieces, each as long as the tolerance allows: dc tau^2 / 12, seen through
  /// what lies before it. A piece that errs by more is halved, one that passes is followed by one twice as long.
  HWY_NOINLINE void integrate_pieces(Float length, const Point& front, const Point& back, Mask lanes,
                                     Accumulated& sum) const {
    const Float one = constant(1.0f);
    const Float span = hn::Sub(back.position, front.position);
    // One node is fine enough: the colour is nearly linear there.
    const Float shortest = hn::Div(one, hn::Max(hn::Abs(span), one));
    Point at = front;
    Float variation = variation_at(front.position);
    Float t = constant(0.0f), step = one;
    Mask active = lanes;
    while (!hn::AllFalse(kFloat, active)) {
      const Mask last = hn::Ge(hn::Add(t, step), one);
      const Float next_t = hn::IfThenElse(last, one, hn::Add(t, step));
      const Point next = point_at(hn::IfThenElse(last, back.position, multiply_add(span, next_t, front.position)));
      const Float next_variation = variation_at(next.position);
      Float integrals[4];
      integrate_anywhere(at, next, hn::IfThenElseZero(active, hn::Mul(length, hn::Sub(next_t, t))), integrals);

      const Float depth = integrals[0];
      const Float change = hn::Min(one, hn::Abs(hn::Sub(next_variation, variation)));
      const Float error = hn::Mul(hn::Mul(hn::Mul(depth, depth), change), sum.transmittance);
      const Mask fine = hn::Or(hn::Le(error, constant(split_threshold_)), hn::Le(step, shortest));
      const Mask accepted = hn::And(active, fine);
      for (Float& integral : integrals) integral = hn::IfThenElseZero(accepted, integral);
      composite_piece(integrals[0], integrals + 1, absorbed_ratio(integrals[0]), sum);

      replace_front(accepted, next, at);
      variation = hn::IfThenElse(accepted, next_variation, variation);
      t = hn::IfThenElse(accepted, next_t, t);
      step = hn::Mul(step, hn::IfThenElse(accepted, constant(2.0f), constant(0.5f)));
      // What comes after a millionth of the light has no colour to add.
      const Mask done = hn::And(accepted, hn::Or(last, hn::Le(sum.transmittance, constant(1e-6f))));
      active = hn::AndNot(done, active);
    }
  }

  /// From control point to control point, in pieces so thin that self-attenuation is within the tolerance.
  HWY_NOINLINE void integrate_exactly(const Segments& segment, Mask lanes, Accumulated& sum) const {
    const auto find_deepest = [&](const Record& a, const Record& b) {
      const Float green_blue = hn::Max(hn::AbsDiff(a.z, b.z), hn::AbsDiff(a.w, b.w));
      const Float change = hn::Max(hn::Max(hn::AbsDiff(a.y, b.y), green_blue), constant(1e-6f));
      return hn::Sqrt(hn::Div(constant(split_threshold_), change));
    };
    for_each_linear_piece(points_, segment, lanes, find_deepest, sum.transmittance,
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
  bool covers_data_;
};

/// The same where the function is gentle at the table's resolution (meshes: `AntiderivativeTable::is_gentle`; grids,
/// brick by brick: `BrickPlan::is_gentle`): scalars are rounded to nodes, so that a segment costs one 16-byte load
/// instead of three.
class GentleAntiderivativeIntegrator {
 public:
  /// The scalar at the front, the node that stands for it, and the antiderivatives there.
  struct Front {
    Float position;  // in nodes
    Int node;
    Int sums[4];
  };

  explicit GentleAntiderivativeIntegrator(const IntegratorTables& tables)
      : table_(*tables.antiderivative), precise_(tables) {}

  HWY_INLINE Front front_at(Float scalar) const { return front_of(precise_.inside(precise_.position(scalar))); }
  static HWY_INLINE void replace_front(Mask mask, const Front& from, Front& to) {
    to.position = hn::IfThenElse(mask, from.position, to.position);
    to.node = hn::IfThenElse(int_mask(mask), from.node, to.node);
    for (int i = 0; i < 4; ++i) to.sums[i] = hn::IfThenElse(int_mask(mask), from.sums[i], to.sums[i]);
  }

  /// See above.
  static HWY_INLINE void move_front(const Front& from, Front& to) {
    to.position = from.position;
    to.node = from.node;
    to.sums[0] = from.sums[0];
    to.sums[1] = from.sums[1];
    to.sums[2] = from.sums[2];
    to.sums[3] = from.sums[3];
  }

  HWY_INLINE void integrate(const Segments& segment, Front& front, Accumulated& sum) const {
    const Front back = front_at(segment.scalar_back);
    const Float nodes = hn::ConvertTo(kFloat, hn::Sub(back.node, front.node));
    const Mask flat = hn::Lt(hn::Abs(hn::Sub(back.position, front.position)), constant(kFlatNodes));
    const Float scale = hn::Div(hn::Mul(segment.length, constant(table_.density_per_unit)),
                                hn::IfThenElse(flat, constant(1.0f), nodes));
    Float integrals[4];
    for (int i = 0; i < 4; ++i)
      integrals[i] = hn::Mul(hn::ConvertTo(kFloat, hn::Sub(back.sums[i], front.sums[i])), scale);
    // Rays that have nothing to integrate do not count.
    if (!hn::AllFalse(kFloat, hn::And(flat, hn::Gt(segment.length, constant(0.0f))))) {
      const Float middle = hn::Mul(constant(0.5f), hn::Add(back.position, front.position));
      precise_.integrate_flat(middle, segment.length, flat, integrals);
    }

    const Mask beyond = precise_.is_beyond(segment);
    const Mask doubtful = hn::Or(precise_.may_err(integrals[0], hn::Abs(nodes), sum), beyond);
    if (HWY_LIKELY(hn::AllFalse(kFloat, doubtful)))
      composite_piece(integrals[0], integrals + 1, absorbed_ratio_series(integrals[0]), sum);
    else
      precise_.integrate_doubtful(segment, precise_.front_at(segment.scalar_front),
                                  precise_.front_at(segment.scalar_back), integrals, doubtful, hn::FirstN(kFloat, 0),
                                  sum);
    move_front(back, front);
  }

 private:
  static constexpr float kFlatNodes = optics::AntiderivativeTable::kFlatNodes;

  HWY_INLINE Front front_of(Float position) const {
    const Int node = round_small(position);
    const Record record =
        load_table_records(table_.entries.data()->sums.data(), hn::BitCast(kUint, hn::Add(node, node)));
    return {position,
            node,
            {hn::BitCast(kInt, record.x), hn::BitCast(kInt, record.y), hn::BitCast(kInt, record.z),
             hn::BitCast(kInt, record.w)}};
  }

  const optics::AntiderivativeTable& table_;
  AntiderivativeIntegrator precise_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
