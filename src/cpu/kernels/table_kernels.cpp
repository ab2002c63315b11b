#include "src/cpu/kernels/kernel_sets.h"

#include <cstddef>
#include <cstdint>

// This file is compiled once for each instruction set: Highway includes it again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/kernels/table_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h
#include <hwy/highway.h>

#include "src/cpu/kernels/effect_march-inl.h"
#include "src/cpu/kernels/effects-inl.h"
#include "src/cpu/kernels/march-inl.h"
#include "src/cpu/kernels/sample-inl.h"
#include "src/cpu/kernels/table-inl.h"
#include "src/cpu/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

WalkStatistics walk_table(const WalkJob& job) { return Walker<TableIntegrator, false>(job).run(); }

WalkStatistics illustrate_walk_table(const WalkJob& job) {
  return Walker<EffectIntegrator<TableIntegrator>, false, true>(job).run();
}

std::uint64_t march_table(const MarchJob& job, int count) { return Marcher<TableIntegrator>(job).run(count); }

std::uint64_t sample_table(const MarchJob& job, int count) {
  return RateMarcher<ScalarSampler<TableIntegrator>>(job).run(count);
}

std::uint64_t illustrate_march_table(const MarchJob& job, int count) {
  return EffectMarcher<EffectIntegrator<TableIntegrator>, false>(job).run(count);
}

void look_up_segments(const IntegratorTables& tables, const SegmentArrays& segments, float* colors) {
  const TableIntegrator integrator(tables);
  HWY_ALIGN float in[3][kLanes];
  HWY_ALIGN float out[4][kLanes];
  for (std::size_t first = 0; first < segments.count; first += kLanes) {
    const std::size_t lanes = segments.count - first < kLanes ? segments.count - first : kLanes;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t i = first + (lane < lanes ? lane : 0);
      in[0][lane] = segments.scalar_front[i];
      in[1][lane] = segments.scalar_back[i];
      in[2][lane] = segments.length[i];
    }
    const Record found =
        integrator.look_up({hn::Load(kFloat, in[0]), hn::Load(kFloat, in[1]), hn::Load(kFloat, in[2])});
    hn::Store(found.x, kFloat, out[0]);
    hn::Store(found.y, kFloat, out[1]);
    hn::Store(found.z, kFloat, out[2]);
    hn::Store(found.w, kFloat, out[3]);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (std::size_t channel = 0; channel < 4; ++channel) colors[4 * (first + lane) + channel] = out[channel][lane];
  }
}

void add_tables(Kernels& kernels) {
  kernels.tables = {&walk_table,      &march_table, &sample_table, &illustrate_walk_table, &illustrate_march_table,
                    &look_up_segments};
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetravox::cpu {

HWY_EXPORT(add_tables);

void add_table_kernels(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(add_tables)(kernels); }

}  // namespace tetravox::cpu
#endif
