#pragma once

/// The kernels by source, each set compiled in a file of its own: for the instruction set that Highway has chosen.

#include "src/cpu/kernels/kernels.h"

namespace tetravox::cpu {

void add_walk_kernels(Kernels& kernels);    ///< of meshes
void add_march_kernels(Kernels& kernels);   ///< of grids
void add_packet_kernels(Kernels& kernels);  ///< of grids whose values serve as they lie, at a fixed rate
void add_effect_kernels(Kernels& kernels);  ///< of both, with effects
void add_table_kernels(Kernels& kernels);   ///< of both, for the integrators that look ray integrals up
void add_domain_kernels(Kernels& kernels);  ///< of both, for functions of several variables

}  // namespace tetravox::cpu
