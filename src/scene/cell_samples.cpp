#include "src/scene/cell_samples.h"

#include "src/support/threads.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <mutex>

namespace tetravox::scene {
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

std::array<std::uint32_t, 4> sorted_vertices(const PreparedMesh& mesh, const Entry& entry) {
  const auto [a, b, c] = entry.face;
  std::array<std::uint32_t, 4> ids{a, b, c, mesh.cells[entry.cell].vertex_xor ^ a ^ b ^ c};
  std::sort(ids.begin(), ids.end());
  return ids;
}

CellSample make_sample(const PreparedMesh& mesh, std::uint32_t cell, const std::array<std::uint32_t, 4>& ids) {
  CellSample sample;
  std::array<std::array<double, 3>, 4> p;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vertex& vertex = mesh.vertices[ids[i]];
    p[i] = {vertex.x, vertex.y, vertex.z};
    sample.scalars[i] = mesh.association == Association::kCell ? mesh.cell_scalars[cell] : vertex.scalar;
  }
  std::array<std::array<double, 3>, 3> e;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) e[i][k] = p[i + 1][k] - p[0][k];
  const double determinant = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                             e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                             e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
  sample.volume = static_cast<float>(std::abs(determinant) / 6.0);
  return sample;
}

/// The flood: a front of cells moves inwards from the boundary. Each part of the front goes depth first for a while,
/// from neighbour to neighbour, which are near each other in memory; what it has not visited then is the next front.
class Flood {
 public:
  Flood(const PreparedMesh& mesh, std::size_t stride, std::vector<CellSample>& samples)
      : mesh_(mesh), stride_(stride), samples_(samples), visited_(mesh.cells.size()) {}

  void run() {
    constexpr std::size_t kGrain = 512, kCellsAnEntry = 64;
    std::vector<Entry> front;
    for (const BoundaryFace& face : mesh_.boundary)
      if (face.cell < mesh_.cells.size() && visited_.claim(face.cell)) front.push_back({face.cell, face.vertices});
    while (!front.empty()) {
      std::vector<Entry> next;
      std::mutex next_mutex;
      support::parallel_chunks(front.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<Entry> stack(front.begin() + static_cast<std::ptrdiff_t>(begin),
                                 front.begin() + static_cast<std::ptrdiff_t>(end));
        for (std::size_t left = kCellsAnEntry * kGrain; left > 0 && !stack.empty(); --left) {
          const Entry entry = stack.back();
          stack.pop_back();
          visit(entry, stack);
        }
        const std::lock_guard lock(next_mutex);
        next.insert(next.end(), stack.begin(), stack.end());
      });
      front.swap(next);
    }
  }

 private:
  void visit(const Entry& entry, std::vector<Entry>& found) {
    const std::array<std::uint32_t, 4> ids = sorted_vertices(mesh_, entry);
    if (entry.cell % stride_ == 0) samples_[entry.cell / stride_] = make_sample(mesh_, entry.cell, ids);
    for (std::size_t r = 0; r < 4; ++r) {
      const std::uint32_t neighbour = mesh_.cells[entry.cell].neighbours[r];
      if (neighbour == kNoCell || !visited_.claim(neighbour)) continue;
      found.push_back({neighbour, {ids[(r + 1) % 4], ids[(r + 2) % 4], ids[(r + 3) % 4]}});
    }
  }

  const PreparedMesh& mesh_;
  std::size_t stride_;
  std::vector<CellSample>& samples_;
  VisitedCells visited_;
};

}  // namespace

std::vector<CellSample> sample_cells(const PreparedMesh& mesh, std::size_t largest_count) {
  const std::size_t count = mesh.cells.size();
  const std::size_t stride = std::max<std::size_t>(1, (count + largest_count - 1) / largest_count);
  std::vector<CellSample> samples((count + stride - 1) / stride);
  Flood(mesh, stride, samples).run();
  return samples;
}

}  // namespace tetravox::scene
