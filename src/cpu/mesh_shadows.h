#pragma once

/// What absorbs along lines through a mesh.

#include "src/cpu/face_bins.h"
#include "src/cpu/face_tree.h"
#include "src/cpu/shadow_rays.h"
#include "src/mesh/gradients.h"
#include "tetravox/mesh.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tetravox::cpu {

/// Walks from tetrahedron to tetrahedron, from each boundary face where a line enters to where it leaves.
///
/// The walk is that of the picture (kernels/walk-inl.h; after Garrity 1990), in double precision: both neighbours of an
/// edge compute the same product from the same two vertices, and a line that meets an edge or a vertex is taken as
/// moved by the same infinitesimal step for all (Edelsbrunner and Muecke 1990), so that it enters once. Nothing is
/// asked of the place's cell: a place that rounding puts beside the mesh is none the worse.
class MeshShadows final : public ShadowMedium {
 public:
  /// Views everything. `gradients`: [vertices] or, `has_cell_gradients`, [cells]; empty without
  /// `ShadowOptics::weight_by_gradient`.
  MeshShadows(const PreparedMesh& mesh, const FaceTree& faces, const ShadowOptics& optics,
              std::span<const mesh::Gradient> gradients, bool has_cell_gradients)
      : mesh_(mesh), faces_(faces), optics_(optics), gradients_(gradients), has_cell_gradients_(has_cell_gradients) {}

  void expect_parallel(std::size_t light, const Vector3& travel) override;
  void gather(const ShadowLine& line, std::span<const DepthRange> kept, Transmission& sum) const override;

 private:
  struct Corner;
  struct Face;
  struct Meeting;
  class Walk;

  const PreparedMesh& mesh_;
  const FaceTree& faces_;
  ShadowOptics optics_;
  std::span<const mesh::Gradient> gradients_;
  bool has_cell_gradients_;
  std::vector<FaceBins> bins_;  ///< of each light that is parallel, as far as there are
};

}  // namespace tetravox::cpu
