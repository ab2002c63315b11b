#include "src/scene/cell_samples.h"

#include "src/mesh/cell_vertices.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tetravox::scene {
namespace {

CellSample make_sample(const PreparedMesh& mesh, std::uint32_t cell, const mesh::CellVertices& ids) {
  CellSample sample;
  std::array<std::array<double, 3>, 4> p;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vertex& vertex = mesh.vertices[ids[i]];
    p[i] = {vertex.x, vertex.y, vertex.z};
    sample.scalars[i] = mesh.association == Association::kCell ? mesh.cell_scalars[cell] : vertex.scalar;
  }
  std::array<std::array<double, 3>, 3> e;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) e[i][k] = p[i + 1][k] - p[0][k];
  const double determinant = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                             e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                             e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
  sample.volume = static_cast<float>(std::abs(determinant) / 6.0);
  return sample;
}

}  // namespace

std::vector<CellSample> sample_cells(const PreparedMesh& mesh, std::size_t largest_count) {
  const std::size_t count = mesh.cells.size();
  const std::size_t stride = std::max<std::size_t>(1, (count + largest_count - 1) / largest_count);
  std::vector<CellSample> samples((count + stride - 1) / stride);
  mesh::visit_cells(mesh, [&](std::uint32_t cell, const mesh::CellVertices& ids) {
    if (cell % stride == 0) samples[cell / stride] = make_sample(mesh, cell, ids);
  });
  return samples;
}

}  // namespace tetravox::scene
