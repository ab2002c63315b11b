#pragma once

/// Cells of a prepared mesh with their vertices: what statistics of the field need and rays do not.

#include "tetravox/mesh.h"

#include <array>
#include <cstddef>
#include <vector>

namespace tetravox::scene {

/// Stored scalars at the corners of one cell, and its volume in the local frame; volume 0: no such cell.
struct CellSample {
  std::array<float, 4> scalars{};
  float volume = 0.0f;
};

/// Every n-th cell of the mesh, with n as small as leaves at most `largest_count` samples. A cell keeps only the XOR of
/// its vertices, so that the mesh is flooded from its boundary, face by face. In parallel; the same for any number of
/// threads. Cells that no path joins to the boundary are left with volume 0.
std::vector<CellSample> sample_cells(const PreparedMesh& mesh, std::size_t largest_count);

}  // namespace tetravox::scene
