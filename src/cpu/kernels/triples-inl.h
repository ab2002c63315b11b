// Three-vectors of rays, and where places lie in lattices.

#if defined(TETRAVOX_CPU_TRIPLES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_TRIPLES_INL
#undef TETRAVOX_CPU_TRIPLES_INL
#else
#define TETRAVOX_CPU_TRIPLES_INL
#endif

#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Three components of a vector of rays, one each.
struct Triple {
  Float x, y, z;
};

HWY_INLINE Float dot(const Triple& a, const Triple& b) {
  return multiply_add(a.z, b.z, multiply_add(a.y, b.y, hn::Mul(a.x, b.x)));
}
HWY_INLINE Triple scaled(const Triple& a, Float by) { return {hn::Mul(a.x, by), hn::Mul(a.y, by), hn::Mul(a.z, by)}; }
HWY_INLINE Triple sum_of(const Triple& a, const Triple& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Triple constant_triple(const float v[3]) { return {constant(v[0]), constant(v[1]), constant(v[2])}; }
HWY_INLINE Triple normalized(const Triple& a) {
  return scaled(a, hn::Div(constant(1.0f), hn::Sqrt(hn::Max(dot(a, a), constant(1e-30f)))));
}
/// Rows of a matrix with `columns` columns (3, or 4 for an affine map) times a vector.
HWY_INLINE Triple transform(const float* m, int columns, const Triple& a) {
  const auto row = [&](int i) {
    const float* r = m + columns * i;
    const Float sum =
        multiply_add(constant(r[2]), a.z, multiply_add(constant(r[1]), a.y, hn::Mul(constant(r[0]), a.x)));
    return columns == 4 ? hn::Add(sum, constant(r[3])) : sum;
  };
  return {row(0), row(1), row(2)};
}
HWY_INLINE Triple mix(Float t, const Triple& a, const Triple& b) {
  return {multiply_add(t, hn::Sub(b.x, a.x), a.x), multiply_add(t, hn::Sub(b.y, a.y), a.y),
          multiply_add(t, hn::Sub(b.z, a.z), a.z)};
}

/// Where a vector of places lies in a lattice, clamped to it.
struct LatticePlace {
  Int node;     ///< number of the lower corner
  Int step[3];  ///< from corner to corner; 0 along an axis with one point
  Float t[3];   ///< place between the corners

  HWY_INLINE LatticePlace(const std::int32_t sizes[3], const Triple& place) {
    const Float at[3] = {place.x, place.y, place.z};
    node = hn::Zero(kInt);
    std::int32_t stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const float last = static_cast<float>(sizes[axis] - 1);
      const Float inside = hn::Min(hn::Max(at[axis], constant(0.0f)), constant(last));
      const Int index = hn::Min(hn::ConvertTo(kInt, inside), hn::Set(kInt, sizes[axis] > 1 ? sizes[axis] - 2 : 0));
      t[axis] = hn::Sub(inside, hn::ConvertTo(kFloat, index));
      node = hn::Add(node, hn::Mul(index, hn::Set(kInt, stride)));
      step[axis] = hn::Set(kInt, sizes[axis] > 1 ? stride : 0);
      stride *= sizes[axis];
    }
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
