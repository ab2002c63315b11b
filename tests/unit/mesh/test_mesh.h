#pragma once

/// Small meshes to prepare, and a look at what came out: cells as a walking ray would meet them.

#include "src/mesh/builtin.h"
#include "tetravox/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::test {

using Point = std::array<double, 3>;

/// A mesh under construction.
struct TestMesh {
  std::vector<double> points;
  std::vector<CellType> types;
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> connectivity;
  std::vector<double> scalars;
  Association association = Association::kPoint;

  std::uint32_t add_point(const Point& p, double scalar = 0.0) {
    points.insert(points.end(), p.begin(), p.end());
    if (association == Association::kPoint) scalars.push_back(scalar);
    return static_cast<std::uint32_t>(points.size() / 3 - 1);
  }
  void add_cell(CellType type, const std::vector<std::uint32_t>& ids) {
    types.push_back(type);
    connectivity.insert(connectivity.end(), ids.begin(), ids.end());
    offsets.push_back(connectivity.size());
  }
  MeshData view() const {
    MeshData mesh;
    mesh.points = points;
    mesh.cell_types = types;
    mesh.cell_offsets = offsets;
    mesh.connectivity = connectivity;
    mesh.scalars = scalars;
    mesh.association = association;
    mesh.array_name = "field";
    return mesh;
  }
};

inline Point position(const PreparedMesh& mesh, std::uint32_t vertex) {
  const Vertex& v = mesh.vertices[vertex];
  return {mesh.origin[0] + v.x * mesh.world_per_local, mesh.origin[1] + v.y * mesh.world_per_local,
          mesh.origin[2] + v.z * mesh.world_per_local};
}

inline Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// An embedded mesh of about `cells` cells (0: as many as it has by default), with the array of that name.
inline Dataset make_embedded(const std::string& name, std::uint64_t cells = 0, const std::string& array = {}) {
  for (const mesh::BuiltinMeshEntry& entry : mesh::builtin_meshes())
    if (entry.name == name)
      return mesh::make_builtin_mesh(entry, {cells == 0 ? entry.default_cells : cells, {array, {}, {}}, {}}, name);
  ADD_FAILURE() << name;
  return {};
}

using Corners = std::array<std::uint32_t, 4>;

/// The other three corners of a cell, ascending.
inline std::array<std::uint32_t, 3> face_opposite(const Corners& corners, int rank) {
  std::array<std::uint32_t, 3> face{};
  for (int i = 0, n = 0; i < 4; ++i)
    if (i != rank) face[n++] = corners[i];
  return face;
}

/// Vertices of every cell, ascending, found as rays find them: from the boundary inwards, one XOR at a time. Checks on
/// the way that neighbours agree, that all cells are reached and that the boundary is what it says.
inline std::vector<Corners> recover_cells(const PreparedMesh& mesh) {
  std::vector<Corners> cells(mesh.cells.size());
  std::vector<bool> is_known(mesh.cells.size(), false);
  std::vector<std::uint32_t> open;
  const auto enter = [&](std::uint32_t cell, const std::array<std::uint32_t, 3>& face) {
    Corners corners = {face[0], face[1], face[2], mesh.cells[cell].vertex_xor ^ face[0] ^ face[1] ^ face[2]};
    std::sort(corners.begin(), corners.end());
    EXPECT_LT(corners[3], mesh.vertices.size());
    for (int i = 0; i < 3; ++i) EXPECT_LT(corners[i], corners[i + 1]);
    if (is_known[cell]) {
      EXPECT_EQ(cells[cell], corners);
      return;
    }
    is_known[cell] = true;
    cells[cell] = corners;
    open.push_back(cell);
  };
  for (const BoundaryFace& face : mesh.boundary) enter(face.cell, face.vertices);
  std::size_t boundary_sides = 0;
  while (!open.empty()) {
    const std::uint32_t cell = open.back();
    open.pop_back();
    for (int rank = 0; rank < 4; ++rank) {
      const std::uint32_t neighbour = mesh.cells[cell].neighbours[rank];
      if (neighbour == kNoCell) {
        ++boundary_sides;
        continue;
      }
      if (neighbour >= mesh.cells.size()) {
        ADD_FAILURE() << "cell " << cell << " has the neighbour " << neighbour;
        continue;
      }
      const auto& back = mesh.cells[neighbour].neighbours;
      EXPECT_EQ(std::count(back.begin(), back.end(), cell), 1);
      enter(neighbour, face_opposite(cells[cell], rank));
    }
  }
  EXPECT_EQ(boundary_sides, mesh.boundary.size());
  EXPECT_EQ(mesh.report.boundary_faces, mesh.boundary.size());
  EXPECT_EQ(mesh.report.tetrahedra, mesh.cells.size());
  EXPECT_EQ(std::count(is_known.begin(), is_known.end(), false), 0);
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const Corners& corners : cells)
    for (const std::uint32_t vertex : corners) is_used[vertex] = true;
  EXPECT_EQ(std::count(is_used.begin(), is_used.end(), false), 0);
  return cells;
}

inline double volume_of(const PreparedMesh& mesh, const Corners& c) {
  const Point a = position(mesh, c[0]);
  return std::abs(dot(minus(position(mesh, c[1]), a),
                      cross(minus(position(mesh, c[2]), a), minus(position(mesh, c[3]), a)))) /
         6.0;
}

inline double total_volume(const PreparedMesh& mesh) {
  double volume = 0.0;
  for (const Corners& corners : recover_cells(mesh)) volume += volume_of(mesh, corners);
  return volume;
}

/// Area of the boundary; checks that each face points out of its cell.
inline double boundary_area(const PreparedMesh& mesh) {
  const std::vector<Corners> cells = recover_cells(mesh);
  double area = 0.0;
  for (const BoundaryFace& face : mesh.boundary) {
    const auto& v = face.vertices;
    const Point a = position(mesh, v[0]);
    const Point normal = cross(minus(position(mesh, v[1]), a), minus(position(mesh, v[2]), a));
    const Point inside = position(mesh, mesh.cells[face.cell].vertex_xor ^ v[0] ^ v[1] ^ v[2]);
    EXPECT_LT(dot(normal, minus(inside, a)), 0.0);
    area += 0.5 * std::sqrt(dot(normal, normal));
  }
  return area;
}

/// Checks that the boundary is a closed surface: each directed edge occurs as often as its reverse.
inline void expect_closed_boundary(const PreparedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const BoundaryFace& face : mesh.boundary)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = face.vertices[i], b = face.vertices[(i + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  for (const auto& [edge, sum] : balance) EXPECT_EQ(sum, 0) << "edge " << edge.first << " " << edge.second;
}

/// Vertices - edges + faces of the boundary.
inline long boundary_euler(const PreparedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::map<std::uint32_t, int> vertices;
  for (const BoundaryFace& face : mesh.boundary)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = face.vertices[i], b = face.vertices[(i + 1) % 3];
      ++edges[{std::min(a, b), std::max(a, b)}];
      ++vertices[a];
    }
  return static_cast<long>(vertices.size()) - static_cast<long>(edges.size()) + static_cast<long>(mesh.boundary.size());
}

/// n^3 unit hexahedra (or voxels) in [0, n]^3; the scalar is x + 10 y + 100 z.
inline TestMesh make_block(std::uint32_t n, CellType type = CellType::kHexahedron) {
  TestMesh mesh;
  for (std::uint32_t k = 0; k <= n; ++k)
    for (std::uint32_t j = 0; j <= n; ++j)
      for (std::uint32_t i = 0; i <= n; ++i)
        mesh.add_point({double(i), double(j), double(k)}, i + 10.0 * j + 100.0 * k);
  const std::uint32_t row = n + 1, layer = row * row;
  for (std::uint32_t k = 0; k < n; ++k)
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t p = k * layer + j * row + i;
        if (type == CellType::kVoxel)
          mesh.add_cell(
              type, {p, p + 1, p + row, p + row + 1, p + layer, p + layer + 1, p + layer + row, p + layer + row + 1});
        else
          mesh.add_cell(
              type, {p, p + 1, p + row + 1, p + row, p + layer, p + layer + 1, p + layer + row + 1, p + layer + row});
      }
  return mesh;
}

/// One tetrahedron of volume 1/6, moved by `shift` along x.
inline void add_tetrahedron(TestMesh& mesh, double shift = 0.0, double scalar = 0.0) {
  const std::uint32_t p = mesh.add_point({shift, 0, 0}, scalar);
  mesh.add_point({shift + 1, 0, 0}, scalar + 1);
  mesh.add_point({shift, 1, 0}, scalar + 2);
  mesh.add_point({shift, 0, 1}, scalar + 3);
  mesh.add_cell(CellType::kTetrahedron, {p, p + 1, p + 2, p + 3});
}

}  // namespace tetravox::test
