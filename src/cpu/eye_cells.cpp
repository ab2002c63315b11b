#include "src/cpu/eye_cells.h"

#include "src/support/threads.h"

#include <tbb/concurrent_vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tetravox::cpu {
namespace {

/// A vertex relative to the line through the eye along the view.
struct Corner {
  std::uint32_t id = 0;
  double x = 0.0, y = 0.0, z = 0.0;
};

Corner make_corner(const FrameMesh& mesh, const CameraFrame& frame, std::uint32_t id) {
  const float* v = mesh.vertices + 4 * static_cast<std::size_t>(id);
  return {id, v[0] - frame.eye[0], v[1] - frame.eye[1], v[2] - frame.eye[2]};
}

double product(const Corner& a, const Corner& b) { return a.x * b.y - a.y * b.x; }

/// Depth at which the line meets a triangle that holds it.
double depth_in(const std::array<Corner, 3>& t) {
  const std::array<double, 3> weight{product(t[1], t[2]), product(t[2], t[0]), product(t[0], t[1])};
  const double total = weight[0] + weight[1] + weight[2];
  return total > 0.0 ? (weight[0] * t[0].z + weight[1] * t[1].z + weight[2] * t[2].z) / total : t[0].z;
}

/// Walks from the cell behind `face` until the eye is passed. Appends the faces of the cell that holds the eye.
void walk_to_eye(const FrameMesh& mesh, const CameraFrame& frame, std::array<Corner, 3> face, std::uint32_t cell,
                 std::size_t cell_count, tbb::concurrent_vector<std::array<BoundaryFace, 4>>& found) {
  for (std::size_t step = 0; step <= cell_count && cell != kNoCell; ++step) {
    const TetrahedronLinks& links = mesh.cells[cell];
    const std::uint32_t id = links.vertex_xor ^ face[0].id ^ face[1].id ^ face[2].id;
    if (id > mesh.last_vertex) return;
    const Corner d = make_corner(mesh, frame, id);
    std::array<bool, 3> positive{};
    for (int k = 0; k < 3; ++k) positive[k] = product(face[k], d) >= 0.0;
    const int out = positive[2] && !positive[1] ? 0 : (positive[1] && !positive[0] ? 2 : 1);

    const std::array<Corner, 3> entered = face;
    const std::uint32_t replaced = face[out].id;
    const int rank =
        (entered[0].id < replaced) + (entered[1].id < replaced) + (entered[2].id < replaced) + (id < replaced);
    face[out] = d;
    if (depth_in(face) >= 0.0) {
      const std::uint32_t a = entered[0].id, b = entered[1].id, c = entered[2].id;
      found.push_back({BoundaryFace{cell, {a, b, c}}, {cell, {b, a, id}}, {cell, {c, b, id}}, {cell, {a, c, id}}});
      return;
    }
    cell = links.neighbours[rank];
  }
}

}  // namespace

std::vector<BoundaryFace> find_eye_cell_faces(const FrameMesh& mesh, std::span<const BoundaryFace> boundary,
                                              std::size_t cell_count, const CameraFrame& frame) {
  if (frame.is_orthographic) return {};
  tbb::concurrent_vector<std::array<BoundaryFace, 4>> found;
  support::parallel_chunks(boundary.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::array<Corner, 3> face{};
      for (int k = 0; k < 3; ++k) face[k] = make_corner(mesh, frame, boundary[i].vertices[k]);
      const bool entered =
          product(face[0], face[1]) >= 0.0 && product(face[1], face[2]) >= 0.0 && product(face[2], face[0]) >= 0.0;
      if (entered && depth_in(face) < 0.0) walk_to_eye(mesh, frame, face, boundary[i].cell, cell_count, found);
    }
  });

  // In a fixed order, each cell once (the line may touch an edge that two faces share).
  std::vector<std::array<BoundaryFace, 4>> cells(found.begin(), found.end());
  const auto by_cell = [](const auto& a, const auto& b) {
    return a[0].cell != b[0].cell ? a[0].cell < b[0].cell : a[0].vertices < b[0].vertices;
  };
  std::sort(cells.begin(), cells.end(), by_cell);
  cells.erase(
      std::unique(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a[0].cell == b[0].cell; }),
      cells.end());
  std::vector<BoundaryFace> faces;
  for (const auto& four : cells) faces.insert(faces.end(), four.begin(), four.end());
  return faces;
}

}  // namespace tetravox::cpu
