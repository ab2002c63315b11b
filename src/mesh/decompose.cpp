#include "src/mesh/decompose.h"

namespace tetravox::mesh {
namespace {

/// Walks a face stream without trusting it; calls `visit(corner count, position of the first corner)` for each face.
/// Returns whether the stream is well formed and ends where the entry ends.
template <class Visit>
bool walk_face_stream(std::span<const std::uint32_t> entry, const Visit& visit) {
  if (entry.empty()) return false;
  std::size_t at = 1;
  for (std::uint32_t face = 0; face < entry[0]; ++face) {
    if (at >= entry.size()) return false;
    const std::size_t corners = entry[at++];
    if (corners < 3 || corners > entry.size() - at) return false;
    visit(corners, at);
    at += corners;
  }
  return at == entry.size();
}

}  // namespace

CellProblem check_cell(CellType type, std::span<const std::uint32_t> entry, std::size_t point_count) {
  bool are_ids_valid = true;
  if (type == CellType::kPolyhedron) {
    const bool is_stream_valid = walk_face_stream(entry, [&](std::size_t corners, std::size_t at) {
      for (std::size_t i = 0; i < corners; ++i) are_ids_valid &= entry[at + i] < point_count;
    });
    if (!is_stream_valid) return CellProblem::kFaceStream;
    return are_ids_valid ? CellProblem::kNone : CellProblem::kPointId;
  }
  const int count = type == CellType::kTetrahedron ? 4 : cell_table(type).node_count;
  if (count == 0) return CellProblem::kUnknownType;
  if (entry.size() < static_cast<std::size_t>(count)) return CellProblem::kTooShort;
  for (int i = 0; i < count; ++i) are_ids_valid &= entry[i] < point_count;
  return are_ids_valid ? CellProblem::kNone : CellProblem::kPointId;
}

std::uint64_t max_tetrahedra(CellType type, std::span<const std::uint32_t> entry) {
  if (type == CellType::kTetrahedron) return 1;
  if (type != CellType::kPolyhedron) return static_cast<std::uint64_t>(cell_table(type).max_tetrahedra);
  std::uint64_t count = 0;
  walk_face_stream(entry, [&](std::size_t corners, std::size_t) { count += corners - 2; });
  return count;
}

}  // namespace tetravox::mesh
