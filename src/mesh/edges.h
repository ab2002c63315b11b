#pragma once

#include "tetravox/mesh.h"

namespace tetravox::mesh {

/// World length of the longest edge, above 0: no segment in a tetrahedron is longer.
double find_longest_edge(const PreparedMesh& mesh);

}  // namespace tetravox::mesh
