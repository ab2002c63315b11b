#pragma once

/// Boundary faces of a mesh, sorted by where parallel light meets them.

#include "src/cpu/shadow_rays.h"
#include "tetravox/mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::cpu {

/// A lattice across the light, about as many squares as faces (fewer where faces are long), each with the faces that
/// light enters there. Views nothing.
class FaceBins {
 public:
  FaceBins() = default;
  /// `travel`: local unit vector in which the light travels.
  FaceBins(const PreparedMesh& mesh, const Vector3& travel);

  bool is_empty() const { return starts_.empty(); }
  /// Over all squares: at most 16 for each face.
  std::size_t entry_count() const { return faces_.size(); }

  /// Faces of the mesh that a line of this light through `place` (local) may enter through.
  std::span<const std::uint32_t> faces_at(const Vector3& place) const;

 private:
  using Point = std::array<double, 2>;

  /// A face seen along the light.
  struct Projected {
    std::array<Point, 3> corners;
    std::uint32_t number;
  };

  Point project(const Vector3& local) const;
  std::vector<Projected> project_entered(const PreparedMesh& mesh, Point& upper);
  /// How many entries each square has with `side_` squares along each axis, from 1 on; their sum.
  std::size_t count_entries(std::span<const Projected> faces, std::vector<std::size_t>& counts) const;
  template <class Visit>
  void visit_squares(const Projected& face, const Visit& visit) const;
  /// Square along an axis, before it is limited to those that there are.
  double square_of(const Point& at, std::size_t axis) const {
    return (at[axis] - lower_[axis]) * squares_per_length_[axis];
  }

  std::array<int, 3> axes_{};
  Point slopes_{}, lower_{}, squares_per_length_{};
  std::size_t side_ = 1;
  std::vector<std::size_t> starts_;  ///< [side * side + 1], row by row
  std::vector<std::uint32_t> faces_;
};

}  // namespace tetravox::cpu
