#include "src/sort/face_sides.h"

#include "src/support/threads.h"

namespace tetravox::sort {

CellSides find_sides(const PreparedMesh& mesh, const SortedCell& cell, const ViewPoint& view) {
  CellSides sides;
  if (!cell.is_known()) return sides;
  const auto ids = cell.ascending();
  const Vector3 v0 = position_of(mesh.vertices[ids[0]]), v1 = position_of(mesh.vertices[ids[1]]),
                v2 = position_of(mesh.vertices[ids[2]]), v3 = position_of(mesh.vertices[ids[3]]);
  const Vector3 e1 = v1 - v0, e2 = v2 - v0, e3 = v3 - v0;
  const std::array<int, 4> signs{side_of_eye(view, v1, v2 - v1, v3 - v1), side_of_eye(view, v0, e2, e3),
                                 side_of_eye(view, v0, e1, e3), side_of_eye(view, v0, e1, e2)};
  const bool is_negative = cell.is_ascending_negative();
  for (std::size_t rank = 0; rank < 4; ++rank) {
    if (signs[rank] == 0) continue;
    const bool is_eye_outside = (signs[rank] > 0) == is_outwards(rank, is_negative);
    sides.set(rank, is_eye_outside ? Side::kFront : Side::kBehind);
  }
  return sides;
}

void find_cell_sides(const PreparedMesh& mesh, std::span<const SortedCell> cells, const ViewPoint& view,
                     std::vector<CellSides>& sides) {
  constexpr std::size_t kGrain = 1 << 13;
  sides.resize(cells.size());
  support::parallel_chunks(cells.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) sides[cell] = find_sides(mesh, cells[cell], view);
  });
}

}  // namespace tetravox::sort
