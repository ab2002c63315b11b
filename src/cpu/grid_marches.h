#pragma once

/// The kernels that take rays through the bricks of a grid.

#include "src/cpu/domain.h"
#include "src/cpu/grid_packets.h"
#include "src/cpu/kernels/kernels.h"
#include "tetravox/render.h"

#include <cstdint>

namespace tetravox::cpu {

using Integrate = std::uint64_t (*)(const MarchJob&, int);

/// From cell to cell, and in equal steps; both also for bricks in which scalars may be rounded to nodes of the table.
struct Marches {
  Integrate cells = nullptr, strides = nullptr;
  Integrate gentle_cells = nullptr, gentle_strides = nullptr;
};

/// `is_constant`: cells have one value each.
Marches choose_marches(const Kernels& kernels, bool is_constant, const RenderSettings& settings);

/// The same with light, surfaces, weights or depth.
Marches choose_illustrated_marches(const Kernels& kernels, bool is_constant, Integrator integrator);

/// Through a whole grid at a fixed rate: segments integrated one by one, or slabs looked up.
struct PacketMarches {
  GridPackets::March segments = nullptr, slabs = nullptr;
};
PacketMarches choose_packet_marches(const Kernels& kernels, const RenderSettings& settings);

/// Of a function of several variables.
Marches choose_domain_marches(const Kernels& kernels, bool is_constant, const Domain& domain);

}  // namespace tetravox::cpu
