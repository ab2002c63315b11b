#pragma once

/// Cells in an order that keeps all relations, or all but a few where there are cycles.

#include "src/sort/relations.h"
#include "src/sort/view_point.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::sort {

struct CycleReport {
  std::uint64_t cycles = 0, cyclic_cells = 0, broken_relations = 0;
};

/// Memory that is used again.
struct TopologicalBuffers {
  std::vector<std::uint8_t> states;      ///< [cells]
  std::vector<std::uint32_t> gap_waits;  ///< [cells]: rear cells across gaps that are still to come
  std::vector<std::uint32_t> stack;

  std::uint64_t bytes() const {
    return states.capacity() + (gap_waits.capacity() + stack.capacity()) * sizeof(std::uint32_t);
  }
};

/// Fills `order` with all cells, back to front: a cell follows when all behind it have gone (Kahn 1962), the one freed
/// last first, which stays near in memory. Linear in cells and relations.
///
/// Where every cell left waits for another, a cycle is found by going back from the farthest cell that is in one, and
/// the farthest cell of this cycle, by its centroid, goes without waiting.
CycleReport sort_by_counting(const Relations& relations, const ViewPoint& view, TopologicalBuffers& buffers,
                             std::vector<std::uint32_t>& order);

/// Fills `order` with all cells, back to front: depth first towards the back from each cell of `roots` in turn, a cell
/// after all behind it; cells that no root leads to come last. Relations across gaps are not looked at. One that leads
/// back into the path just taken is left out.
CycleReport sort_depth_first(const Relations& relations, std::span<const std::uint32_t> roots,
                             TopologicalBuffers& buffers, std::vector<std::uint32_t>& order);

}  // namespace tetravox::sort
