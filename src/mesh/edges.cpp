#include "src/mesh/edges.h"

#include "src/mesh/cell_vertices.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tetravox::mesh {

double find_longest_edge(const PreparedMesh& mesh) {
  tbb::enumerable_thread_specific<double> longest(0.0);  // squared
  visit_cells(mesh, [&](std::uint32_t, const CellVertices& ids) {
    double& found = longest.local();
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) {
        const Vertex &a = mesh.vertices[ids[i]], &b = mesh.vertices[ids[j]];
        const double x = static_cast<double>(a.x) - b.x, y = static_cast<double>(a.y) - b.y,
                     z = static_cast<double>(a.z) - b.z;
        found = std::max(found, x * x + y * y + z * z);
      }
  });
  const double largest = longest.combine([](double a, double b) { return std::max(a, b); });
  return std::max(std::sqrt(largest) * mesh.world_per_local, static_cast<double>(std::numeric_limits<float>::min()));
}

}  // namespace tetravox::mesh
