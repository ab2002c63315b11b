#include "src/cpu/kernels/kernel_sets.h"

#include <cstdint>

// This file is compiled once for each instruction set: Highway includes it again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/kernels/march_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h
#include <hwy/highway.h>

#include "src/cpu/kernels/antiderivative-inl.h"
#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/march-inl.h"
#include "src/cpu/kernels/rays-inl.h"
#include "src/cpu/kernels/sample-inl.h"
#include "src/cpu/kernels/stride-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

template <class Integrator>
std::uint64_t march(const MarchJob& job, int count) {
  return Marcher<Integrator>(job).run(count);
}

template <class Sampler>
std::uint64_t sample(const MarchJob& job, int count) {
  return RateMarcher<Sampler>(job).run(count);
}

template <class Integrator>
std::uint64_t stride(const MarchJob& job, int count) {
  return Strider<Integrator>(job).run(count);
}

void add_march(Kernels& kernels) {
  kernels.make_records = &make_records;
  kernels.start_march = &start_march;
  kernels.clip_brick = &clip_brick;
  kernels.march_antiderivative = &march<AntiderivativeIntegrator>;
  kernels.march_gentle_antiderivative = &march<GentleAntiderivativeIntegrator>;
  kernels.march_partial = &march<PartialIntegrator>;
  kernels.march_post = &march<PostIntegrator>;
  kernels.stride_antiderivative = &stride<AntiderivativeIntegrator>;
  kernels.stride_gentle_antiderivative = &stride<GentleAntiderivativeIntegrator>;
  kernels.stride_partial = &stride<PartialIntegrator>;
  kernels.march_cells = &march_cells;
  kernels.march_densities = &march_densities;
  kernels.sample_antiderivative = &sample<ScalarSampler<AntiderivativeIntegrator>>;
  kernels.sample_partial = &sample<ScalarSampler<PartialIntegrator>>;
  kernels.sample_post = &sample<ScalarSampler<CellIntegrator>>;
  kernels.sample_densities = &sample<DensitySampler>;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetravox::cpu {

HWY_EXPORT(add_march);

void add_march_kernels(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(add_march)(kernels); }

}  // namespace tetravox::cpu
#endif
