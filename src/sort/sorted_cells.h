#pragma once

/// Vertices of every cell, with its orientation.

#include "tetravox/mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::sort {

/// Four vertex ids. Those of rank 0 and 1 are the two lowest; of rank 2 and 3 the lower one comes first where the
/// ascending order has positive volume, second where it has negative volume.
///
/// Orientation is what `prepare_mesh` found in the input's own numbers; it is handed from the boundary from cell to
/// cell, never computed from the rounded places of the vertices. So both cells of a face agree which of them is on
/// which side, however flat they are.
struct SortedCell {
  std::array<std::uint32_t, 4> ids{kNoCell, kNoCell, kNoCell, kNoCell};

  bool is_known() const { return ids[0] != kNoCell; }
  bool is_ascending_negative() const { return ids[2] > ids[3]; }
  /// Vertices in ascending order: the r-th is opposite the face to `TetrahedronLinks::neighbours[r]`.
  std::array<std::uint32_t, 4> ascending() const {
    return ids[2] < ids[3] ? ids : std::array<std::uint32_t, 4>{ids[0], ids[1], ids[3], ids[2]};
  }
};

/// [cells]. A cell that no path of neighbours joins to the boundary stays unknown.
std::vector<SortedCell> find_sorted_cells(const PreparedMesh& mesh);

/// The three of four ascending ids that are not of this rank, ascending.
inline std::array<std::uint32_t, 3> face_opposite(const std::array<std::uint32_t, 4>& ascending, std::size_t rank) {
  return {ascending[rank > 0 ? 0 : 1], ascending[rank > 1 ? 1 : 2], ascending[rank > 2 ? 2 : 3]};
}

/// Whether the face opposite the vertex of a rank, in ascending order, faces out of the cell.
inline bool is_outwards(std::size_t rank, bool is_ascending_negative) {
  return (rank % 2 == 0) != is_ascending_negative;
}

}  // namespace tetravox::sort
