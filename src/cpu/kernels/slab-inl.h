// Slabs of one thickness: a table of two scalars, and how it is made.

#if defined(TETRAVOX_CPU_SLAB_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_SLAB_INL
#undef TETRAVOX_CPU_SLAB_INL
#else
#define TETRAVOX_CPU_SLAB_INL
#endif

#include "src/cpu/kernels/antiderivative-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The stored scalar at a node.
HWY_INLINE Float scalar_at(const optics::SlabTable& table, Float node) {
  return multiply_add(node, constant(1.0f / table.nodes_per_scalar), constant(table.first));
}

/// Fills the entries of slabs that have node `front` in front.
inline void fill_slabs(const SlabJob& job) {
  constexpr int kNodes = optics::SlabTable::kNodes;
  const AntiderivativeIntegrator integrator(*job.tables);
  const Float front = scalar_at(*job.table, constant(static_cast<float>(job.front)));
  const std::size_t first = static_cast<std::size_t>(job.front) * kNodes;
  float* row = job.table->entries[first].data();
  for (int back = 0; back < kNodes; back += static_cast<int>(kLanes)) {
    Accumulated sum{constant(0.0f), constant(0.0f), constant(0.0f), constant(1.0f)};
    auto at = integrator.front_at(front);
    const Float number = hn::Add(hn::Iota(kFloat, 0.0f), constant(static_cast<float>(back)));
    const Segments slab{front, scalar_at(*job.table, number), constant(job.thickness)};
    integrator.integrate(slab, at, sum);
    const Float alpha = hn::Sub(constant(1.0f), sum.transmittance);
    hn::StoreInterleaved4(sum.red, sum.green, sum.blue, alpha, kFloat, row + 4 * back);
    if (job.table->centers.empty()) continue;
    const Float center = find_emission(job.tables->effects->centroid, slab, alpha).center;
    const Int rounded = hn::NearestInt(hn::Mul(center, constant(optics::SlabTable::kBehind)));
    HWY_ALIGN std::int32_t centers[kLanes];
    hn::Store(rounded, kInt, centers);
    std::copy_n(centers, kLanes, job.table->centers.begin() + static_cast<std::ptrdiff_t>(first) + back);
  }
}

/// Looks slabs up. Scalars are in nodes of the table. What is thinner than a slab, at the ends of a ray, is integrated.
class SlabIntegrator {
 public:
  /// Where the row of the node in front begins.
  struct Front {
    Int row;
  };

  static constexpr bool kRoundsScalars = true;  ///< whether scalars need not be known better than to half a node

  explicit SlabIntegrator(const IntegratorTables& tables)
      : table_(*tables.slabs),
        entries_(table_.entries.data()),
        thin_(constant(kWhole * tables.slab_thickness)),
        precise_(tables) {}

  /// Where a step is seen, from 0 in front to 1 behind.
  HWY_INLINE Float find_center(Float front, Float back) const {
    const Int index = hn::Add(row_of(round_small(front)), round_small(back));
    const auto* centers = reinterpret_cast<const std::int32_t*>(table_.centers.data());
    const Int center = hn::And(hn::GatherOffset(kInt, centers, index), hn::Set(kInt, optics::SlabTable::kBehind));
    return hn::Mul(hn::ConvertTo(kFloat, center), constant(1.0f / optics::SlabTable::kBehind));
  }

  HWY_INLINE Front front_at(Float node) const { return {row_of(round_small(node))}; }

  /// Whole slabs.
  HWY_INLINE void add_whole(Float scalar_back, Front& front, Accumulated& sum) const {
    add(look_up(scalar_back, front), sum.transmittance, sum);
  }

  HWY_INLINE void integrate(const Segments& segment, Front& front, Accumulated& sum) const {
    const Record slab = look_up(segment.scalar_back, front);
    const Mask is_any = hn::Gt(segment.length, constant(0.0f));
    Float visible = hn::IfThenElseZero(is_any, sum.transmittance);
    const Mask is_thin = hn::And(is_any, hn::Lt(segment.length, thin_));
    if (HWY_UNLIKELY(!hn::AllFalse(kFloat, is_thin))) {
      visible = hn::IfThenZeroElse(is_thin, visible);
      integrate_thin(segment, is_thin, sum);
    }
    add(slab, visible, sum);
  }

 private:
  /// A thousandth less than a slab is whole: lengths are rounded.
  static constexpr float kWhole = 0.999f;

  static_assert(optics::SlabTable::kNodes == 512);
  static HWY_INLINE Int row_of(Int node) { return hn::ShiftLeft<9>(node); }

  /// The slabs from `front` to a scalar, which becomes `front`.
  HWY_INLINE Record look_up(Float scalar_back, Front& front) const {
    const Int node = round_small(scalar_back);
    const Record slab = load_table_records(entries_, hn::BitCast(kUint, hn::Add(front.row, node)));
    front = {row_of(node)};
    return slab;
  }
  static HWY_INLINE void add(const Record& slab, Float visible, Accumulated& sum) {
    sum.red = multiply_add(visible, slab.x, sum.red);
    sum.green = multiply_add(visible, slab.y, sum.green);
    sum.blue = multiply_add(visible, slab.z, sum.blue);
    sum.transmittance = hn::Sub(sum.transmittance, hn::Mul(visible, slab.w));
  }

  HWY_NOINLINE void integrate_thin(const Segments& segment, Mask is_thin, Accumulated& sum) const {
    const Float scalar_front = scalar_at(table_, segment.scalar_front);
    auto front = precise_.front_at(scalar_front);
    const Float scalar_back = scalar_at(table_, segment.scalar_back);
    precise_.integrate({scalar_front, scalar_back, hn::IfThenElseZero(is_thin, segment.length)}, front, sum);
  }

  const optics::SlabTable& table_;
  const void* entries_;
  Float thin_;
  AntiderivativeIntegrator precise_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
