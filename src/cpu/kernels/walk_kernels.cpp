#include "src/cpu/kernels/kernel_sets.h"

// This file is compiled once for each instruction set: Highway includes it again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/kernels/walk_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h
#include <hwy/highway.h>

#include "src/cpu/kernels/antiderivative-inl.h"
#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/rasterize-inl.h"
#include "src/cpu/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

template <class Integrator, bool kCellData>
WalkStatistics walk(const WalkJob& job) {
  return Walker<Integrator, kCellData>(job).run();
}

void add_walk(Kernels& kernels) {
  kernels.rasterize_face = &rasterize_face;
  kernels.walk_antiderivative = &walk<AntiderivativeIntegrator, false>;
  kernels.walk_gentle_antiderivative = &walk<GentleAntiderivativeIntegrator, false>;
  kernels.walk_partial = &walk<PartialIntegrator, false>;
  kernels.walk_post = &walk<PostIntegrator, false>;
  kernels.walk_cells = &walk<CellIntegrator, true>;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetravox::cpu {

HWY_EXPORT(add_walk);

void add_walk_kernels(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(add_walk)(kernels); }

}  // namespace tetravox::cpu
#endif
