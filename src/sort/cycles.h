#pragma once

/// Cells that hide one another in a circle.

#include "src/sort/relations.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::sort {

struct CycleCount {
  std::uint64_t cycles = 0;          ///< strongly connected components of more than one cell
  std::vector<std::uint32_t> cells;  ///< in them
};

/// Finds the cycles among the cells for which `is_left` is not 0, without recursion and in linear time (Tarjan 1972).
CycleCount find_cycles(const Relations& relations, std::span<const std::uint8_t> is_left);

}  // namespace tetravox::sort
