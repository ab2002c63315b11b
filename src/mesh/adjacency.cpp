#include "src/mesh/adjacency.h"

#include "src/support/check.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

namespace tetravox::mesh {
namespace {

constexpr std::size_t kTetrahedraPerChunk = 1 << 16;
constexpr std::size_t kVerticesPerChunk = 1 << 13;

/// One side of a face, known by the two higher of its vertices (the lowest is the bucket's).
struct FaceSide {
  std::uint64_t vertices;  ///< middle << 32 | highest
  std::uint32_t cell;
  std::uint8_t rank;         ///< of the vertex opposite
  std::uint8_t is_outwards;  ///< the face in ascending order faces out of the cell

  bool operator<(const FaceSide& other) const {
    return vertices != other.vertices ? vertices < other.vertices : cell < other.cell;
  }
};

/// Whether the face opposite the vertex of a rank, in ascending order, faces out of the cell.
bool is_outwards(const Tetrahedron& cell, int rank) { return (rank % 2 == 0) != cell.is_ascending_negative(); }

FaceSide make_side(std::uint32_t middle, std::uint32_t highest, std::size_t cell, const Tetrahedron& t, int rank) {
  return {std::uint64_t{middle} << 32 | highest, static_cast<std::uint32_t>(cell), static_cast<std::uint8_t>(rank),
          static_cast<std::uint8_t>(is_outwards(t, rank))};
}

/// Cells by their second lowest vertex: those whose face opposite the lowest vertex belongs to a bucket.
struct SecondVertexLists {
  Buffer<std::uint32_t> cells;
  std::vector<std::uint32_t> end;  ///< [vertices]

  std::size_t begin(std::size_t vertex) const { return vertex == 0 ? 0 : end[vertex - 1]; }
};

SecondVertexLists list_by_second_vertex(const TetrahedronList& list) {
  SecondVertexLists lists;
  lists.end.assign(list.bucket_end.size(), 0);
  lists.cells = Buffer<std::uint32_t>(list.count);
  const auto increase = [&](std::size_t cell) {
    return std::atomic_ref<std::uint32_t>(lists.end[list.tetrahedra[cell].v[1]])
        .fetch_add(1, std::memory_order_relaxed);
  };
  support::parallel_chunks(list.count, kTetrahedraPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) increase(cell);
  });
  std::uint32_t begin = 0;
  for (std::uint32_t& count : lists.end) begin += std::exchange(count, begin);
  support::parallel_chunks(list.count, kTetrahedraPerChunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t cell = first; cell < last; ++cell) lists.cells[increase(cell)] = static_cast<std::uint32_t>(cell);
  });
  return lists;
}

/// Finds neighbours across the faces of one lowest vertex after another.
class FaceMatcher {
 public:
  FaceMatcher(const TetrahedronList& list, const SecondVertexLists& second, std::vector<TetrahedronLinks>& cells)
      : list_(list), second_(second), cells_(cells) {}

  void match(std::size_t vertex) {
    gather(vertex);
    std::sort(sides_.begin(), sides_.end());
    for (std::size_t begin = 0; begin < sides_.size();) {
      std::size_t end = begin + 1;
      while (end < sides_.size() && sides_[end].vertices == sides_[begin].vertices) ++end;
      connect(begin, end);
      begin = end;
    }
  }

  std::uint64_t boundary_faces = 0;
  std::uint64_t overlapping_faces = 0;

 private:
  void gather(std::size_t vertex) {
    sides_.clear();
    for (std::size_t cell = list_.bucket_begin(vertex); cell < list_.bucket_end[vertex]; ++cell) {
      const Tetrahedron& t = list_.tetrahedra[cell];
      sides_.push_back(make_side(t.third(), t.fourth(), cell, t, 1));
      sides_.push_back(make_side(t.v[1], t.fourth(), cell, t, 2));
      sides_.push_back(make_side(t.v[1], t.third(), cell, t, 3));
    }
    for (std::size_t i = second_.begin(vertex); i < second_.end[vertex]; ++i) {
      const Tetrahedron& t = list_.tetrahedra[second_.cells[i]];
      sides_.push_back(make_side(t.third(), t.fourth(), second_.cells[i], t, 0));
    }
  }

  /// Decides about the sides [begin, end) of one face.
  void connect(std::size_t begin, std::size_t end) {
    const FaceSide& a = sides_[begin];
    const FaceSide& b = sides_[end - 1];
    if (end - begin == 2 && a.is_outwards != b.is_outwards) {
      cells_[a.cell].neighbours[a.rank] = b.cell;
      cells_[b.cell].neighbours[b.rank] = a.cell;
      return;
    }
    for (std::size_t i = begin; i < end; ++i) cells_[sides_[i].cell].neighbours[sides_[i].rank] = kNoCell;
    boundary_faces += end - begin;
    overlapping_faces += end - begin > 1;
  }

  const TetrahedronList& list_;
  const SecondVertexLists& second_;
  std::vector<TetrahedronLinks>& cells_;
  std::vector<FaceSide> sides_;
};

/// The face opposite the vertex of a rank, facing outwards.
std::array<std::uint32_t, 3> outward_face(const Tetrahedron& cell, int rank) {
  const std::array<std::uint32_t, 4> ascending = {cell.v[0], cell.v[1], cell.third(), cell.fourth()};
  std::array<std::uint32_t, 3> face{};
  for (int i = 0, n = 0; i < 4; ++i)
    if (i != rank) face[n++] = ascending[i];
  if (!is_outwards(cell, rank)) std::swap(face[1], face[2]);
  return face;
}

}  // namespace

Adjacency find_neighbours(const TetrahedronList& list, ProgressMeter& meter) {
  Adjacency adjacency;
  const SecondVertexLists second = list_by_second_vertex(list);
  adjacency.cells.resize(list.count);
  std::atomic<std::uint64_t> boundary{0}, overlapping{0};
  support::parallel_chunks(list.bucket_end.size(), kVerticesPerChunk, [&](std::size_t first, std::size_t last) {
    FaceMatcher matcher(list, second, adjacency.cells);
    for (std::size_t vertex = first; vertex < last; ++vertex) {
      for (std::size_t cell = list.bucket_begin(vertex); cell < list.bucket_end[vertex]; ++cell) {
        const auto& v = list.tetrahedra[cell].v;
        adjacency.cells[cell].vertex_xor = v[0] ^ v[1] ^ v[2] ^ v[3];
      }
      matcher.match(vertex);
    }
    boundary += matcher.boundary_faces;
    overlapping += matcher.overlapping_faces;
    meter.advance(list.bucket_end[last - 1] - list.bucket_begin(first));
  });
  adjacency.boundary_faces = boundary;
  adjacency.overlapping_faces = overlapping;
  return adjacency;
}

std::vector<BoundaryFace> collect_boundary(const TetrahedronList& list, const std::vector<TetrahedronLinks>& cells,
                                           std::uint64_t count) {
  // Find where each chunk of cells writes.
  const std::size_t chunks = (cells.size() + kTetrahedraPerChunk - 1) / kTetrahedraPerChunk;
  std::vector<std::uint64_t> begin(chunks + 1, 0);
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk)
      for (std::size_t c = chunk * kTetrahedraPerChunk; c < std::min(cells.size(), (chunk + 1) * kTetrahedraPerChunk);
           ++c)
        for (const std::uint32_t neighbour : cells[c].neighbours) begin[chunk + 1] += neighbour == kNoCell;
  });
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) begin[chunk + 1] += begin[chunk];
  TETRAVOX_CHECK_EQ(begin[chunks], count);
  std::vector<BoundaryFace> boundary(count);
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk) {
      std::uint64_t at = begin[chunk];
      for (std::size_t c = chunk * kTetrahedraPerChunk; c < std::min(cells.size(), (chunk + 1) * kTetrahedraPerChunk);
           ++c)
        for (int rank = 0; rank < 4; ++rank)
          if (cells[c].neighbours[rank] == kNoCell)
            boundary[at++] = {static_cast<std::uint32_t>(c), outward_face(list.tetrahedra[c], rank)};
    }
  });
  return boundary;
}

}  // namespace tetravox::mesh
