#include "src/mesh/gradients.h"

#include "src/mesh/cell_vertices.h"
#include "src/support/check.h"
#include "src/support/threads.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace tetravox::mesh {
namespace {

constexpr std::size_t kCellGrain = 1 << 14;
constexpr std::size_t kVertexGrain = 1 << 12;
constexpr double kLargest = 1e18;  // its square is a float

using Vector = std::array<double, 3>;

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Vertices of all cells, and the cells around each vertex in ascending order.
struct Topology {
  explicit Topology(const PreparedMesh& mesh);

  std::vector<CellVertices> cells;   // [cells]
  std::vector<std::uint64_t> begin;  // [vertices + 1] into `around`
  std::vector<std::uint32_t> around;
};

Topology::Topology(const PreparedMesh& mesh) : cells(find_cell_vertices(mesh)), begin(mesh.vertices.size() + 1) {
  const auto for_each_corner = [&](auto visit) {
    support::parallel_chunks(cells.size(), kCellGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t cell = first; cell < last; ++cell)
        for (const std::uint32_t vertex : cells[cell])
          if (vertex != kNoCell) visit(static_cast<std::uint32_t>(cell), vertex);
    });
  };
  const auto next = [](std::uint64_t& place) {
    return std::atomic_ref<std::uint64_t>(place).fetch_add(1, std::memory_order_relaxed);
  };
  for_each_corner([&](std::uint32_t, std::uint32_t vertex) { next(begin[vertex]); });
  // Turn counts into the places where lists begin; writing moves each place to where its list ends.
  std::uint64_t total = 0;
  for (std::uint64_t& place : begin) total += std::exchange(place, total);
  around.resize(total);
  for_each_corner([&](std::uint32_t cell, std::uint32_t vertex) { around[next(begin[vertex])] = cell; });
  std::copy_backward(begin.begin(), begin.end() - 1, begin.end());
  begin.front() = 0;
  // The order in which threads came must not show.
  support::parallel_chunks(mesh.vertices.size(), kVertexGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t vertex = first; vertex < last; ++vertex)
      std::sort(around.begin() + static_cast<std::ptrdiff_t>(begin[vertex]),
                around.begin() + static_cast<std::ptrdiff_t>(begin[vertex + 1]));
  });
}

/// Edges of a cell from its first vertex, and the normals of the faces between them.
struct CellShape {
  CellShape(const PreparedMesh& mesh, const CellVertices& ids) {
    const Vertex& origin = mesh.vertices[ids[0]];
    std::array<Vector, 3> edges;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& vertex = mesh.vertices[ids[i + 1]];
      edges[i] = {static_cast<double>(vertex.x) - origin.x, static_cast<double>(vertex.y) - origin.y,
                  static_cast<double>(vertex.z) - origin.z};
    }
    normals = {cross(edges[1], edges[2]), cross(edges[2], edges[0]), cross(edges[0], edges[1])};
    determinant = edges[0][0] * normals[0][0] + edges[0][1] * normals[0][1] + edges[0][2] * normals[0][2];
  }

  std::array<Vector, 3> normals{};  // [i]: of the face without edge i
  double determinant = 0.0;         // six times the signed volume
};

/// Six times the volume of a cell, and its gradient times that: no division, so that thin cells do no harm.
struct Weighted {
  double volume = 0.0;
  Vector gradient{};
};

Weighted weigh_cell(const PreparedMesh& mesh, const std::vector<float>& scalars, const CellVertices& ids) {
  const CellShape shape(mesh, ids);
  if (shape.determinant == 0.0) return {};
  Weighted weighted{std::abs(shape.determinant), {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const double rise = static_cast<double>(scalars[ids[i + 1]]) - scalars[ids[0]];
    for (std::size_t axis = 0; axis < 3; ++axis)
      weighted.gradient[axis] += (shape.determinant > 0.0 ? rise : -rise) * shape.normals[i][axis];
  }
  return weighted;
}

/// The quotient, shortened where it is too long.
Gradient divide(const Weighted& sum) {
  double largest = 0.0;
  for (const double component : sum.gradient) largest = std::max(largest, std::abs(component));
  if (!(sum.volume > 0.0) || !(largest > 0.0)) return {};
  // Length and direction apart: the quotient of a thin cell may be no number at all.
  const double length = std::min(largest / sum.volume, kLargest);
  Gradient gradient{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    gradient[axis] = static_cast<float>(sum.gradient[axis] / largest * length);
  return gradient;
}

std::vector<float> vertex_scalars(const PreparedMesh& mesh, const Topology& topology) {
  std::vector<float> scalars(mesh.vertices.size());
  const bool with_cell_data = mesh.association == Association::kCell;
  support::parallel_chunks(scalars.size(), kVertexGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t vertex = first; vertex < last; ++vertex) {
      if (!with_cell_data) {
        scalars[vertex] = mesh.vertices[vertex].scalar;
        continue;
      }
      double sum = 0.0, volume = 0.0;
      for (std::uint64_t i = topology.begin[vertex]; i < topology.begin[vertex + 1]; ++i) {
        const std::uint32_t cell = topology.around[i];
        const double weight = std::abs(CellShape(mesh, topology.cells[cell]).determinant);
        sum += weight * mesh.cell_scalars[cell];
        volume += weight;
      }
      scalars[vertex] = volume > 0.0 ? static_cast<float>(sum / volume) : 0.0f;
    }
  });
  return scalars;
}

std::vector<Gradient> vertex_gradients(const PreparedMesh& mesh, const std::vector<float>& scalars,
                                       const Topology& topology) {
  std::vector<Gradient> gradients(mesh.vertices.size());
  support::parallel_chunks(gradients.size(), kVertexGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t vertex = first; vertex < last; ++vertex) {
      Weighted sum;
      for (std::uint64_t i = topology.begin[vertex]; i < topology.begin[vertex + 1]; ++i) {
        const Weighted cell = weigh_cell(mesh, scalars, topology.cells[topology.around[i]]);
        sum.volume += cell.volume;
        for (std::size_t axis = 0; axis < 3; ++axis) sum.gradient[axis] += cell.gradient[axis];
      }
      gradients[vertex] = divide(sum);
    }
  });
  return gradients;
}

}  // namespace

std::vector<float> vertex_scalars(const PreparedMesh& mesh) {
  if (mesh.association == Association::kCell) return vertex_scalars(mesh, Topology(mesh));
  std::vector<float> scalars(mesh.vertices.size());
  for (std::size_t i = 0; i < scalars.size(); ++i) scalars[i] = mesh.vertices[i].scalar;
  return scalars;
}

std::vector<Gradient> cell_gradients(const PreparedMesh& mesh) {
  const std::vector<float> scalars = vertex_scalars(mesh);
  std::vector<Gradient> gradients(mesh.cells.size());
  visit_cells(mesh, [&](std::uint32_t cell, const CellVertices& ids) {
    gradients[cell] = divide(weigh_cell(mesh, scalars, ids));
  });
  return gradients;
}

std::vector<Gradient> vertex_gradients(const PreparedMesh& mesh) {
  const Topology topology(mesh);
  return vertex_gradients(mesh, vertex_scalars(mesh, topology), topology);
}

std::vector<Gradient> vertex_gradients(const PreparedMesh& mesh, const std::vector<float>& scalars) {
  TETRAVOX_CHECK_EQ(scalars.size(), mesh.vertices.size());
  return vertex_gradients(mesh, scalars, Topology(mesh));
}

}  // namespace tetravox::mesh
