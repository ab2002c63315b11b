#include "src/cpu/kernels/kernel_sets.h"

#include <cstdint>

// This file is compiled once for each instruction set: Highway includes it again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/kernels/packet_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h
#include <hwy/highway.h>

#include "src/cpu/kernels/antiderivative-inl.h"
#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/packet_march-inl.h"
#include "src/cpu/kernels/slab-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

template <class Integrator, bool kIsLit>
std::uint64_t march_packets(const PacketJob& job) {
  switch (job.values->value_bytes) {
    case 1:
      return PacketMarcher<std::uint8_t, Integrator, kIsLit>(job).run();
    case 2:
      return PacketMarcher<std::int16_t, Integrator, kIsLit>(job).run();
    default:
      return PacketMarcher<float, Integrator, kIsLit>(job).run();
  }
}

void add_packets(Kernels& kernels) {
  kernels.packets_antiderivative = &march_packets<AntiderivativeIntegrator, false>;
  kernels.packets_partial = &march_packets<PartialIntegrator, false>;
  kernels.packets_slabs = &march_packets<SlabIntegrator, false>;
  kernels.light_packets_antiderivative = &march_packets<AntiderivativeIntegrator, true>;
  kernels.light_packets_partial = &march_packets<PartialIntegrator, true>;
  kernels.light_packets_slabs = &march_packets<SlabIntegrator, true>;
  kernels.fill_slabs = &fill_slabs;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetravox::cpu {

HWY_EXPORT(add_packets);

void add_packet_kernels(Kernels& kernels) { HWY_DYNAMIC_DISPATCH(add_packets)(kernels); }

}  // namespace tetravox::cpu
#endif
