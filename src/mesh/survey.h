#pragma once

/// First look at a mesh: is it valid, which cells have values, which points are needed, how many tetrahedra at most.

#include "src/mesh/buffer.h"
#include "src/mesh/progress_meter.h"
#include "tetravox/dataset.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::mesh {

/// Input cells that are looked at together.
inline constexpr std::size_t kCellsPerChunk = 8192;

struct Survey {
  Buffer<std::uint8_t> is_used;               ///< [points]: 1 where a cell that is kept has this point
  std::vector<std::uint64_t> max_tetrahedra;  ///< [chunks]: upper bounds
  std::uint64_t missing_value_cells = 0;
};

/// Point ids (or face stream) of a cell.
inline std::span<const std::uint32_t> cell_entry(const MeshData& mesh, std::size_t cell) {
  const std::uint64_t begin = mesh.cell_offsets[cell];
  return mesh.connectivity.subspan(begin, mesh.cell_offsets[cell + 1] - begin);
}

/// Checks the sizes of the arrays against each other.
/// @throws Error (kBadFile, kUnsupported).
void validate_sizes(const MeshData& mesh);

/// Validates every cell and marks what the cells with values need. The sizes are valid.
/// @throws Error: kBadFile, kUnsupported with the lowest bad cell; kCancelled.
Survey survey_cells(const MeshData& mesh, ProgressMeter& meter);

/// Upper bound of the tetrahedra of a mesh that need not be valid.
std::uint64_t count_max_tetrahedra(const MeshData& mesh);

}  // namespace tetravox::mesh
