#pragma once

/// The last order, put right for a new view.

#include "src/sort/relations.h"
#include "src/sort/topological_order.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace tetravox::sort {

/// Memory that is used again.
struct RepairBuffers {
  std::vector<std::uint32_t> places;  ///< [cells]: in the order
  std::vector<std::uint32_t> sorted;  ///< cells of the stretches that are sorted anew

  std::uint64_t bytes() const { return (places.capacity() + sorted.capacity()) * sizeof(std::uint32_t); }
};

/// Changes `order`, back to front, so that it keeps all relations; returns how many cells that took.
///
/// A relation that the order does not keep any more spans a stretch of it. Stretches that overlap become one, and each
/// is sorted by its own relations alone: what lies before and behind it stays there, so that no relation between a cell
/// within and one without can break. Between near views few faces turn over, and the stretches are short.
/// Returns nothing, and leaves the order as it is, where they take up more than half of it, or hold a cycle.
std::optional<std::uint64_t> repair_order(const Relations& relations, RepairBuffers& repair,
                                          TopologicalBuffers& buffers, std::vector<std::uint32_t>& order);

}  // namespace tetravox::sort
