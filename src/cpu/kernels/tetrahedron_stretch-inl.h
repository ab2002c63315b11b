// What rays pass in tetrahedra, as effects ask for it.

#if defined(TETRAVOX_CPU_TETRAHEDRON_STRETCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_TETRAHEDRON_STRETCH_INL
#undef TETRAVOX_CPU_TETRAHEDRON_STRETCH_INL
#else
#define TETRAVOX_CPU_TETRAHEDRON_STRETCH_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// What a vector of rays passes in its tetrahedra (see stretches-inl.h). Vertices a, b, c are those of the entry face,
/// d the fourth; in the exit face d has taken the place of one of them.
struct TetrahedronStretch {
  static constexpr bool kIsLinear = true;

  Float scalar_front, scalar_back, z_front, z_back, length;
  const FrameMesh& mesh;
  Uint cell, id[3], d;
  Float front_weights[3], back_weights[3];
  Mask is_replaced[3];

  HWY_INLINE Float scalar(Float u) const { return multiply_add(u, hn::Sub(scalar_back, scalar_front), scalar_front); }

  HWY_INLINE Triple gradient(Float u) const {
    if (mesh.has_cell_gradients) {
      const Record record = load_records(mesh.gradients, cell);
      return {record.x, record.y, record.z};
    }
    Float weights[4];
    find_weights(u, weights);
    Triple sum{constant(0.0f), constant(0.0f), constant(0.0f)};
    for (int k = 0; k < 4; ++k) {
      const Record record = load_records(mesh.gradients, k < 3 ? id[k] : d);
      sum = sum_of(sum, scaled({record.x, record.y, record.z}, weights[k]));
    }
    return sum;
  }

  HWY_INLINE Float other(int axis, Float u) const {
    const float* others = mesh.others[axis];
    if (mesh.cell_scalars) return hn::GatherIndex(kFloat, others, hn::BitCast(kInt, cell));
    Float weights[4], sum = constant(0.0f);
    find_weights(u, weights);
    for (int k = 0; k < 4; ++k)
      sum = multiply_add(hn::GatherIndex(kFloat, others, hn::BitCast(kInt, k < 3 ? id[k] : d)), weights[k], sum);
    return sum;
  }

 private:
  /// Barycentric coordinates of a place for a, b, c, d.
  HWY_INLINE void find_weights(Float u, Float weights[4]) const {
    const Float v = hn::Sub(constant(1.0f), u);
    weights[3] = constant(0.0f);
    for (int k = 0; k < 3; ++k) {
      const Float back = hn::Mul(u, back_weights[k]);
      weights[k] = multiply_add(v, front_weights[k], hn::IfThenZeroElse(is_replaced[k], back));
      weights[3] = hn::Add(weights[3], hn::IfThenElseZero(is_replaced[k], back));
    }
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
