#pragma once

/// Which cell must be composited before which: across faces, and across gaps.

#include "src/sort/face_sides.h"
#include "src/sort/sorted_cells.h"
#include "tetravox/mesh.h"

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::sort {

/// `front` hides a part of `behind`, with nothing of the mesh required in between.
struct GapRelation {
  std::uint32_t behind = kNoCell, front = kNoCell;

  auto operator<=>(const GapRelation&) const = default;
};

/// All relations of a view. A directed graph over the cells.
struct Relations {
  const PreparedMesh* mesh = nullptr;
  std::span<const SortedCell> cells;
  std::span<const CellSides> sides;   ///< [cells]
  std::span<const GapRelation> gaps;  ///< ascending, without repetitions

  std::size_t cell_count() const { return cells.size(); }

  /// The relations of which `cell` is the rear one.
  std::span<const GapRelation> gaps_behind(std::uint32_t cell) const;

  /// Calls `visit(front)` for every cell that `cell` must be composited before, seen from the back.
  template <class Visit>
  void for_each_front(std::uint32_t cell, const Visit& visit) const {
    for (std::size_t rank = 0; rank < 4; ++rank)
      if (sides[cell][rank] == Side::kFront && mesh->cells[cell].neighbours[rank] != kNoCell)
        visit(mesh->cells[cell].neighbours[rank]);
    for (const GapRelation& gap : gaps_behind(cell)) visit(gap.front);
  }
  /// Calls `visit(behind)` for every neighbour behind the cell; relations across gaps not included.
  template <class Visit>
  void for_each_neighbour_behind(std::uint32_t cell, const Visit& visit) const {
    for (std::size_t rank = 0; rank < 4; ++rank)
      if (sides[cell][rank] == Side::kBehind && mesh->cells[cell].neighbours[rank] != kNoCell)
        visit(mesh->cells[cell].neighbours[rank]);
  }
};

}  // namespace tetravox::sort
