#pragma once

#include "tetravox/dataset.h"

#include <string>

namespace tetravox::io {

/// Checks that a mesh keeps the promises of `MeshData`: sizes of all arrays, offsets ascending and inside, known cell
/// types with enough corners, ids below the point count, polyhedron streams that end where they should, finite
/// coordinates. Parallel.
/// @throws Error (kBadFile) that names `file`, the array and the index.
void validate_mesh(const MeshData& mesh, const std::string& file);

/// Corners that a cell of this type has at least; 0 for a polyhedron and for types that are not known.
int corner_count(CellType type);

}  // namespace tetravox::io
