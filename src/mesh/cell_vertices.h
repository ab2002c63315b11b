#pragma once

/// The four vertices of every cell. A cell keeps only their XOR, so that the mesh is flooded from its boundary, face by
/// face.

#include "tetravox/mesh.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace tetravox::mesh {

/// Vertices of a cell, ascending: the r-th is opposite the face to `TetrahedronLinks::neighbours[r]`.
using CellVertices = std::array<std::uint32_t, 4>;

/// Calls `visit` once for every cell that a path of neighbours joins to the boundary, in no fixed order, from many
/// threads at a time.
void visit_cells(const PreparedMesh& mesh,
                 const std::function<void(std::uint32_t cell, const CellVertices& vertices)>& visit);

/// Vertices of every cell, [cells]; `kNoCell` four times for one that no path joins to the boundary. In parallel; the
/// same for any number of threads.
std::vector<CellVertices> find_cell_vertices(const PreparedMesh& mesh);

}  // namespace tetravox::mesh
