#include "src/cpu/grid_marches.h"

#include "src/scene/preintegration_cache.h"
#include "tetravox/error.h"

namespace tetravox::cpu {

Marches choose_marches(const Kernels& kernels, bool is_constant, const RenderSettings& settings) {
  const bool has_rate = settings.samples_per_voxel > 0.0;
  const auto both = [](Integrate cells, Integrate strides) { return Marches{cells, strides, cells, strides}; };
  if (is_constant) return both(kernels.march_cells, nullptr);
  switch (settings.integrator) {
    case Integrator::kPartial:
      return both(has_rate ? kernels.sample_partial : kernels.march_partial, kernels.stride_partial);
    case Integrator::kPost:
      return both(has_rate ? kernels.sample_post : kernels.march_post, nullptr);
    case Integrator::kPre:
      return both(has_rate ? kernels.sample_densities : kernels.march_densities, nullptr);
    case Integrator::kTable3d:
    case Integrator::kPolynomial:
      return both(has_rate ? kernels.tables.sample : kernels.tables.march, nullptr);
    case Integrator::kCylindrical:
      throw Error(ErrorCode::kUnsupported,
                  "the integrator cylindrical is for meshes; grids have the same table as table3d");
    case Integrator::kAntiderivative:
      break;
  }
  return {has_rate ? kernels.sample_antiderivative : kernels.march_antiderivative, kernels.stride_antiderivative,
          has_rate ? kernels.sample_antiderivative : kernels.march_gentle_antiderivative,
          kernels.stride_gentle_antiderivative};
}

Marches choose_illustrated_marches(const Kernels& kernels, bool is_constant, Integrator integrator) {
  const auto both = [](Integrate cells, Integrate strides) { return Marches{cells, strides, cells, strides}; };
  if (is_constant) return both(kernels.illustrate_march_cells, nullptr);
  if (integrator == Integrator::kPartial)
    return both(kernels.illustrate_march_partial, kernels.illustrate_stride_partial);
  if (integrator == Integrator::kPost) return both(kernels.illustrate_march_post, nullptr);
  if (scene::is_of_tables(integrator)) return both(kernels.tables.illustrate_march, nullptr);
  return {kernels.illustrate_march_antiderivative, kernels.illustrate_stride_antiderivative,
          kernels.illustrate_march_gentle_antiderivative, kernels.illustrate_stride_gentle_antiderivative};
}

PacketMarches choose_packet_marches(const Kernels& kernels, const RenderSettings& settings) {
  const bool is_partial = settings.integrator == Integrator::kPartial;
  if (settings.lighting.is_lit())
    return {is_partial ? kernels.light_packets_partial : kernels.light_packets_antiderivative,
            kernels.light_packets_slabs};
  return {is_partial ? kernels.packets_partial : kernels.packets_antiderivative, kernels.packets_slabs};
}

Marches choose_domain_marches(const Kernels& kernels, bool is_constant, const Domain& domain) {
  const Kernels::OfDomain& set = choose_domain_kernels(kernels, domain);
  const Integrate march = is_constant ? set.march_cells : set.march;
  return {march, nullptr, march, nullptr};
}

}  // namespace tetravox::cpu
