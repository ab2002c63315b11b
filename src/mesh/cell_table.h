#pragma once

/// How each type of cell is cut into convex linear parts, as tables of local node numbers (VTK's order).
///
/// Linear cells are one part. Quadratic cells without nodes on a face are cut at each corner through the adjacent
/// mid-edge nodes ("rectified"): what remains is a polyhedron of mid-edge nodes. Where a type has nodes in the middle
/// of its faces it is cut into smaller cells of the same kind. Either way the cut of a face depends on the nodes of
/// that face alone, so that two cells agree on it.

#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::mesh {

/// A polygon of local nodes, in a cyclic order.
struct CellFace {
  int count = 0;
  std::array<std::uint8_t, 6> nodes{};
};

/// A convex polyhedron that is split by pulling.
struct CellPart {
  std::vector<CellFace> faces;
  std::vector<std::uint8_t> nodes;  ///< that occur in `faces`
  int apex = -1;                    ///< node that all faces are joined to; -1: the lowest of `nodes`
};

struct CellTable {
  int node_count = 0;      ///< 0: not a type with a table (unknown, or polyhedron)
  int max_tetrahedra = 0;  ///< upper bound of what pulling gives
  std::vector<CellPart> parts;
};

/// Largest `node_count` of any table.
inline constexpr int kLargestNodeCount = 27;

/// The table of a type; one with `node_count` 0 for unknown types and for polyhedra. Thread-safe.
const CellTable& cell_table(CellType type);

}  // namespace tetravox::mesh
