#include "src/cpu/kernels/kernel_sets.h"

#include <cstdint>

// This file is compiled once for each instruction set: Highway includes it again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/kernels/domain_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h
#include <hwy/highway.h>

#include "src/cpu/kernels/domain-inl.h"
#include "src/cpu/kernels/effect_march-inl.h"
#include "src/cpu/kernels/effects-inl.h"
#include "src/cpu/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

template <class Function>
using DomainEffects = EffectIntegrator<DomainIntegrator<Function>>;

template <class Function, bool kCellData>
WalkStatistics walk_domain(const WalkJob& job) {
  return Walker<DomainEffects<Function>, kCellData, true>(job).run();
}

template <class Function, bool kIsConstant>
std::uint64_t march_domain(const MarchJob& job, int count) {
  return EffectMarcher<DomainEffects<Function>, kIsConstant>(job).run(count);
}

template <class Function>
Kernels::OfDomain make_domain_kernels() {
  return {&walk_domain<Function, false>, &walk_domain<Function, true>, &march_domain<Function, false>,
          &march_domain<Function, true>};
}

void add_domains(Kernels& kernels) {
  kernels.domain_2d = make_domain_kernels<TableFunction<2>>();
  kernels.domain_3d = make_domain_kernels<TableFunction<3>>();
  kernels.separate_colors = make_domain_kernels<SeparateFunction>();
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetravox::cpu {

HWY_EXPORT(add_domains);

void add_domain_kernels(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(add_domains)(kernels); }

}  // namespace tetravox::cpu
#endif
