#pragma once

/// Tetrahedra -> neighbours and boundary.

#include "src/mesh/progress_meter.h"
#include "src/mesh/tetrahedra.h"
#include "tetravox/mesh.h"

#include <cstdint>
#include <vector>

namespace tetravox::mesh {

struct Adjacency {
  std::vector<TetrahedronLinks> cells;
  std::uint64_t boundary_faces = 0;
  std::uint64_t overlapping_faces = 0;
};

/// Connects cells across each face that exactly two of them have, one on either side.
/// @throws Error (kCancelled).
Adjacency find_neighbours(const TetrahedronList& list, ProgressMeter& meter);

/// The `count` faces without neighbour, in order of cell and rank of the opposite vertex, facing outwards.
std::vector<BoundaryFace> collect_boundary(const TetrahedronList& list, const std::vector<TetrahedronLinks>& cells,
                                           std::uint64_t count);

}  // namespace tetravox::mesh
