#include "src/cpu/kernels/kernels.h"

#include "tetravox/error.h"

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

// This file is compiled once for each instruction set: Highway includes it again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/kernels/kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h
#include <hwy/highway.h>

#include "src/cpu/kernels/antiderivative-inl.h"
#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/march-inl.h"
#include "src/cpu/kernels/rasterize-inl.h"
#include "src/cpu/kernels/rays-inl.h"
#include "src/cpu/kernels/sample-inl.h"
#include "src/cpu/kernels/stride-inl.h"
#include "src/cpu/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

template <class Integrator, bool kCellData>
WalkStatistics walk(const WalkJob& job) {
  return Walker<Integrator, kCellData>(job).run();
}

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

Kernels make_kernels() {
  Kernels kernels;
  kernels.rasterize_face = &rasterize_face;
  kernels.walk_antiderivative = &walk<AntiderivativeIntegrator, false>;
  kernels.walk_gentle_antiderivative = &walk<GentleAntiderivativeIntegrator, false>;
  kernels.walk_partial = &walk<PartialIntegrator, false>;
  kernels.walk_post = &walk<PostIntegrator, false>;
  kernels.walk_cells = &walk<CellIntegrator, true>;
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
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetravox::cpu {

HWY_EXPORT(make_kernels);

namespace {

struct NamedKernels {
  std::string name;
  Kernels kernels;
};

/// Kernels of every target that this machine supports, best first, made once.
const std::vector<NamedKernels>& all_kernels() {
  static const std::vector<NamedKernels> all = [] {
    std::vector<NamedKernels> made;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::GetChosenTarget().Update(target);
      made.push_back({hwy::TargetName(target), HWY_DYNAMIC_DISPATCH(make_kernels)()});
    }
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return made;
  }();
  return all;
}

}  // namespace

std::vector<std::string> available_instruction_sets() {
  std::vector<std::string> names;
  for (const NamedKernels& named : all_kernels()) names.push_back(named.name);
  return names;
}

std::string best_instruction_set() { return all_kernels().front().name; }

const Kernels& kernels_for(const std::string& instruction_set) {
  std::string names;
  for (const NamedKernels& named : all_kernels()) {
    if (instruction_set.empty() || instruction_set == named.name) return named.kernels;
    names += (names.empty() ? "" : ", ") + named.name;
  }
  throw Error(ErrorCode::kInvalidArgument,
              "instruction set '" + instruction_set + "' is not available here: choose one of " + names);
}

}  // namespace tetravox::cpu
#endif
