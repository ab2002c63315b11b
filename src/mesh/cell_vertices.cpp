#include "src/mesh/cell_vertices.h"

#include "src/support/threads.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>

namespace tetravox::mesh {
namespace {

/// A cell about to be visited and the face through which it was reached.
struct Entry {
  std::uint32_t cell = kNoCell;
  std::array<std::uint32_t, 3> face{};
};

/// One bit for each cell, set once.
class VisitedCells {
 public:
  explicit VisitedCells(std::size_t count) : words_((count + 63) / 64) {}

  /// True for the one caller that is first.
  bool claim(std::uint32_t cell) {
    const std::uint64_t bit = std::uint64_t{1} << (cell % 64);
    const std::atomic_ref<std::uint64_t> word(words_[cell / 64]);
    if (word.load(std::memory_order_relaxed) & bit) return false;
    return !(word.fetch_or(bit, std::memory_order_relaxed) & bit);
  }

 private:
  std::vector<std::uint64_t> words_;
};

CellVertices sorted_vertices(const PreparedMesh& mesh, const Entry& entry) {
  const auto [a, b, c] = entry.face;
  CellVertices ids{a, b, c, mesh.cells[entry.cell].vertex_xor ^ a ^ b ^ c};
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace

/// A front of cells moves inwards from the boundary. Each part of the front goes depth first for a while, from
/// neighbour to neighbour, which are near each other in memory; what it has not visited then is the next front.
void visit_cells(const PreparedMesh& mesh, const std::function<void(std::uint32_t, const CellVertices&)>& visit) {
  constexpr std::size_t kGrain = 512, kCellsAnEntry = 64;
  VisitedCells visited(mesh.cells.size());
  const auto enter = [&](const Entry& entry, std::vector<Entry>& found) {
    const CellVertices ids = sorted_vertices(mesh, entry);
    visit(entry.cell, ids);
    for (std::size_t r = 0; r < 4; ++r) {
      const std::uint32_t neighbour = mesh.cells[entry.cell].neighbours[r];
      if (neighbour == kNoCell || !visited.claim(neighbour)) continue;
      found.push_back({neighbour, {ids[(r + 1) % 4], ids[(r + 2) % 4], ids[(r + 3) % 4]}});
    }
  };
  std::vector<Entry> front;
  for (const BoundaryFace& face : mesh.boundary)
    if (face.cell < mesh.cells.size() && visited.claim(face.cell)) front.push_back({face.cell, face.vertices});
  while (!front.empty()) {
    std::vector<Entry> next;
    std::mutex next_mutex;
    support::parallel_chunks(front.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<Entry> stack(front.begin() + static_cast<std::ptrdiff_t>(begin),
                               front.begin() + static_cast<std::ptrdiff_t>(end));
      for (std::size_t left = kCellsAnEntry * kGrain; left > 0 && !stack.empty(); --left) {
        const Entry entry = stack.back();
        stack.pop_back();
        enter(entry, stack);
      }
      const std::lock_guard lock(next_mutex);
      next.insert(next.end(), stack.begin(), stack.end());
    });
    front.swap(next);
  }
}

std::vector<CellVertices> find_cell_vertices(const PreparedMesh& mesh) {
  std::vector<CellVertices> vertices(mesh.cells.size(), {kNoCell, kNoCell, kNoCell, kNoCell});
  visit_cells(mesh, [&](std::uint32_t cell, const CellVertices& ids) { vertices[cell] = ids; });
  return vertices;
}

}  // namespace tetravox::mesh
