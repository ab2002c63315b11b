// Integrators that evaluate the control points: partial pre-integration, point samples, cell data.

#if defined(TETRAVOX_CPU_INTEGRATORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_INTEGRATORS_INL
#undef TETRAVOX_CPU_INTEGRATORS_INL
#else
#define TETRAVOX_CPU_INTEGRATORS_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// For integrators that keep nothing of the front.
struct WithoutFront {
  struct Front {};
  HWY_INLINE Front front_at(Float) const { return {}; }
  static HWY_INLINE void replace_front(Mask, const Front&, Front&) {}
};

/// Adds a piece of constant colour.
HWY_INLINE void composite_uniform(const Record& optics, Float length, Accumulated& sum) {
  const Float depth = hn::Mul(optics.x, length);
  const Float emission[3] = {hn::Mul(depth, optics.y), hn::Mul(depth, optics.z), hn::Mul(depth, optics.w)};
  composite_piece(depth, emission, absorbed_ratio(depth), sum);
}

/// Partial pre-integration: exact for piecewise linear functions (Moreland and Angel 2004), the control points met in
/// order along the segment (Espinha and Celes 2005).
class PartialIntegrator : public WithoutFront {
 public:
  explicit PartialIntegrator(const IntegratorTables& tables)
      : points_(*tables.control_points), absorbed_(tables.transparency->absorbed.data()) {}

  HWY_INLINE void integrate(const Segments& segment, Front&, Accumulated& sum) const {
    for_each_linear_piece(
        points_, segment, hn::Gt(segment.length, constant(0.0f)),
        [](const Record&, const Record&) { return constant(kDeepest); }, sum.transmittance,
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
class PostIntegrator : public WithoutFront {
 public:
  explicit PostIntegrator(const IntegratorTables& tables) : points_(*tables.control_points), samples_(tables.samples) {}

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
class CellIntegrator : public WithoutFront {
 public:
  explicit CellIntegrator(const IntegratorTables& tables) : points_(*tables.control_points) {}

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
