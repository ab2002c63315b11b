#include "src/cpu/kernels/kernel_sets.h"

#include <cstdint>

// This file is compiled once for each instruction set: Highway includes it again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/kernels/effect_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h
#include <hwy/highway.h>

#include "src/cpu/kernels/antiderivative-inl.h"
#include "src/cpu/kernels/effect_march-inl.h"
#include "src/cpu/kernels/effects-inl.h"
#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

template <class Integrator, bool kCellData>
WalkStatistics illustrate_walk(const WalkJob& job) {
  return Walker<EffectIntegrator<Integrator>, kCellData, true>(job).run();
}

template <class Integrator, bool kIsConstant>
std::uint64_t illustrate_march(const MarchJob& job, int count) {
  return EffectMarcher<EffectIntegrator<Integrator>, kIsConstant>(job).run(count);
}

template <class Integrator>
std::uint64_t illustrate_stride(const MarchJob& job, int count) {
  return EffectStrider<EffectIntegrator<Integrator>>(job).run(count);
}

void add_effects(Kernels& kernels) {
  kernels.illustrate_walk_antiderivative = &illustrate_walk<AntiderivativeIntegrator, false>;
  kernels.illustrate_walk_gentle_antiderivative = &illustrate_walk<GentleAntiderivativeIntegrator, false>;
  kernels.illustrate_walk_partial = &illustrate_walk<PartialIntegrator, false>;
  kernels.illustrate_walk_post = &illustrate_walk<PostIntegrator, false>;
  kernels.illustrate_walk_cells = &illustrate_walk<CellIntegrator, true>;
  kernels.illustrate_march_antiderivative = &illustrate_march<AntiderivativeIntegrator, false>;
  kernels.illustrate_march_gentle_antiderivative = &illustrate_march<GentleAntiderivativeIntegrator, false>;
  kernels.illustrate_stride_antiderivative = &illustrate_stride<AntiderivativeIntegrator>;
  kernels.illustrate_stride_gentle_antiderivative = &illustrate_stride<GentleAntiderivativeIntegrator>;
  kernels.illustrate_stride_partial = &illustrate_stride<PartialIntegrator>;
  kernels.illustrate_march_partial = &illustrate_march<PartialIntegrator, false>;
  kernels.illustrate_march_post = &illustrate_march<PostIntegrator, false>;
  kernels.illustrate_march_cells = &illustrate_march<CellIntegrator, true>;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetravox::cpu {

HWY_EXPORT(add_effects);

void add_effect_kernels(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(add_effects)(kernels); }

}  // namespace tetravox::cpu
#endif
