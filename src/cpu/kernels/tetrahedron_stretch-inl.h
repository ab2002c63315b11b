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

  static constexpr bool kHasLinearGradient = true;
  HWY_INLINE void end_gradients(Triple ends[2]) const {
    if (mesh.has_cell_gradients) {
      ends[0] = ends[1] = load(cell);
      return;
    }
    const Triple fourth = load(d);
    for (int end = 0; end < 2; ++end) ends[end] = {constant(0.0f), constant(0.0f), constant(0.0f)};
    for (int k = 0; k < 3; ++k) {
      const Triple corner = load(id[k]);
      const auto exit = [&](Float a, Float b) { return hn::IfThenElse(is_replaced[k], b, a); };
      ends[0] = sum_of(ends[0], scaled(corner, front_weights[k]));
      ends[1] = sum_of(ends[1], scaled({exit(corner.x, fourth.x), exit(corner.y, fourth.y), exit(corner.z, fourth.z)},
                                       back_weights[k]));
    }
  }
  HWY_INLINE Triple gradient(Float u) const {
    Triple ends[2];
    end_gradients(ends);
    return mix(u, ends[0], ends[1]);
  }

  HWY_INLINE Float other(int axis, Float u) const {
    const float* others = mesh.others[axis];
    if (mesh.cell_scalars) return hn::GatherIndex(kFloat, others, hn::BitCast(kInt, cell));
    const auto load_other = [&](Uint vertex) { return hn::GatherIndex(kFloat, others, hn::BitCast(kInt, vertex)); };
    const Float v = hn::Sub(constant(1.0f), u), fourth = load_other(d);
    Float sum = constant(0.0f);
    for (int k = 0; k < 3; ++k) {
      const Float corner = load_other(id[k]), exit = hn::IfThenElse(is_replaced[k], fourth, corner);
      sum = multiply_add(hn::Mul(v, front_weights[k]), corner, sum);
      sum = multiply_add(hn::Mul(u, back_weights[k]), exit, sum);
    }
    return sum;
  }

 private:
  HWY_INLINE Triple load(Uint number) const {
    const Record record = load_records(mesh.gradients, number);
    return {record.x, record.y, record.z};
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
