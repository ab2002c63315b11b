#pragma once

/// On which side of a face the eye is, and what follows for the two cells of the face.

#include "src/sort/sorted_cells.h"
#include "src/sort/view_point.h"
#include "tetravox/mesh.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::sort {

/// What is on the other side of a face of a cell, as seen from the eye.
enum class Side : std::uint8_t {
  kEdgeOn = 0,  ///< the eye is in the plane of the face, to within rounding: no ray of any width passes the face
  kFront = 1,   ///< nearer to the eye than the cell
  kBehind = 2   ///< farther
};

/// Sides of the four faces of a cell, by rank, two bits each.
class CellSides {
 public:
  CellSides() = default;
  explicit CellSides(std::uint8_t bits) : bits_(bits) {}
  Side operator[](std::size_t rank) const { return static_cast<Side>(bits_ >> (2 * rank) & 3); }
  void set(std::size_t rank, Side side) {
    bits_ = static_cast<std::uint8_t>(bits_ | static_cast<unsigned>(side) << (2 * rank));
  }
  bool operator==(const CellSides&) const = default;

 private:
  std::uint8_t bits_ = 0;
};
static_assert(sizeof(CellSides) == 1);

/// +1 where the eye is on the side of the face from which a, b, c run counter-clockwise, -1 on the other side, 0 in its
/// plane to within rounding.
///
/// Called with the vertices in ascending order, so that both cells of a face do the same sums and get the same answer.
/// Edges of vertices are differences of floats: the product of two is as good as exact, and the bound covers the
/// rest. So a sign that is given is the true one; where none is given the face's picture is narrower than rounding.
inline int side_of_eye(const ViewPoint& view, const Vector3& a, const Vector3& edge_b, const Vector3& edge_c) {
  constexpr double kRoundingErrors = 2e-15;
  const Vector3 arm = view.towards_eye(a);
  const double volume = dot(cross(edge_b, edge_c), arm);
  const double bound = kRoundingErrors * norm1(edge_b) * norm1(edge_c) * norm1(arm);
  return volume > bound ? 1 : volume < -bound ? -1 : 0;
}

/// [cells]; of unknown cells all edge-on. In parallel.
void find_cell_sides(const PreparedMesh& mesh, std::span<const SortedCell> cells, const ViewPoint& view,
                     std::vector<CellSides>& sides);

/// Of one cell, as above.
CellSides find_sides(const PreparedMesh& mesh, const SortedCell& cell, const ViewPoint& view);

}  // namespace tetravox::sort
