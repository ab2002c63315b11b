#include "src/sort/sorted_cells.h"

#include <algorithm>
#include <utility>

namespace tetravox::sort {
namespace {

/// A cell about to be visited, and the face through which it was reached, ascending.
struct Entry {
  std::uint32_t cell = kNoCell;
  std::array<std::uint32_t, 3> face{};
  bool is_outwards = false;  ///< the face in ascending order faces out of the cell
};

SortedCell make_cell(const PreparedMesh& mesh, const Entry& entry) {
  const auto& [a, b, c] = entry.face;
  const std::uint32_t apex = mesh.cells[entry.cell].vertex_xor ^ a ^ b ^ c;
  std::size_t rank = 0;
  while (rank < 3 && entry.face[rank] < apex) ++rank;
  SortedCell cell;
  for (std::size_t i = 0, n = 0; i < 4; ++i) cell.ids[i] = i == rank ? apex : entry.face[n++];
  if (entry.is_outwards != is_outwards(rank, false)) std::swap(cell.ids[2], cell.ids[3]);
  return cell;
}

Entry make_entry(const BoundaryFace& face) {
  Entry entry{face.cell, face.vertices, true};
  // Three swaps sort; each turns the face round.
  const auto order = [&entry](std::size_t i, std::size_t j) {
    if (entry.face[i] <= entry.face[j]) return;
    std::swap(entry.face[i], entry.face[j]);
    entry.is_outwards = !entry.is_outwards;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return entry;
}

}  // namespace

std::vector<SortedCell> find_sorted_cells(const PreparedMesh& mesh) {
  std::vector<SortedCell> cells(mesh.cells.size());
  std::vector<Entry> stack;
  const auto enter = [&](const Entry& entry) {
    if (entry.cell >= cells.size() || cells[entry.cell].is_known()) return;
    cells[entry.cell] = make_cell(mesh, entry);
    stack.push_back(entry);
  };
  for (const BoundaryFace& face : mesh.boundary) {
    enter(make_entry(face));
    while (!stack.empty()) {
      const std::uint32_t cell = stack.back().cell;
      stack.pop_back();
      const auto ascending = cells[cell].ascending();
      const bool is_negative = cells[cell].is_ascending_negative();
      for (std::size_t rank = 0; rank < 4; ++rank)
        // What faces out of this cell faces into its neighbour.
        enter({mesh.cells[cell].neighbours[rank], face_opposite(ascending, rank), !is_outwards(rank, is_negative)});
    }
  }
  return cells;
}

}  // namespace tetravox::sort
