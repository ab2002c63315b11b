#include "tests/reference/tetrahedra.h"

#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <tuple>

namespace tetravox::reference {
namespace {

using Polygon = std::vector<std::uint32_t>;

/// Faces of the cell types as corner numbers, in VTK's order of corners; the sense of rotation does not matter here.
const std::map<CellType, std::vector<Polygon>>& faces_by_type() {
  static const std::map<CellType, std::vector<Polygon>> kFaces = {
      {CellType::kTetrahedron, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}}},
      {CellType::kVoxel, {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}},
      {CellType::kHexahedron, {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
      {CellType::kWedge, {{0, 1, 2}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
      {CellType::kPyramid, {{0, 1, 2, 3}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}},
      {CellType::kPentagonalPrism,
       {{0, 1, 2, 3, 4}, {5, 6, 7, 8, 9}, {0, 1, 6, 5}, {1, 2, 7, 6}, {2, 3, 8, 7}, {3, 4, 9, 8}, {4, 0, 5, 9}}},
      {CellType::kHexagonalPrism,
       {{0, 1, 2, 3, 4, 5},
        {6, 7, 8, 9, 10, 11},
        {0, 1, 7, 6},
        {1, 2, 8, 7},
        {2, 3, 9, 8},
        {3, 4, 10, 9},
        {4, 5, 11, 10},
        {5, 0, 6, 11}}}};
  return kFaces;
}

std::vector<Polygon> polyhedron_faces(std::span<const std::uint32_t> stream) {
  std::vector<Polygon> faces(stream[0]);
  std::size_t at = 1;
  for (Polygon& face : faces) {
    const std::uint32_t count = stream[at++];
    face.assign(stream.begin() + at, stream.begin() + at + count);
    at += count;
  }
  return faces;
}

/// Faces of cell `cell` as point ids.
std::vector<Polygon> cell_faces(const MeshData& mesh, std::size_t cell) {
  const std::size_t begin = mesh.cell_offsets[cell];
  const auto ids = mesh.connectivity.subspan(begin, mesh.cell_offsets[cell + 1] - begin);
  if (mesh.cell_types[cell] == CellType::kPolyhedron) return polyhedron_faces(ids);
  const auto found = faces_by_type().find(mesh.cell_types[cell]);
  if (found == faces_by_type().end())
    throw Error(ErrorCode::kUnsupported, "cell " + std::to_string(cell) + ": the reference splits linear cells only");
  std::vector<Polygon> faces = found->second;
  for (Polygon& face : faces) {
    for (std::uint32_t& corner : face) {
      if (corner >= ids.size())
        throw Error(ErrorCode::kBadFile, "cell " + std::to_string(cell) + " has too few points");
      corner = ids[corner];
    }
  }
  return faces;
}

/// For each point the first one that coincides with it and carries an equal value.
std::vector<std::uint32_t> first_of_coinciding(const Tetrahedra& result) {
  std::map<std::tuple<double, double, double, double>, std::uint32_t> first;
  std::vector<std::uint32_t> representative(result.points.size());
  for (std::uint32_t point = 0; point < result.points.size(); ++point) {
    const auto& p = result.points[point];
    const double scalar = result.point_scalars.empty() ? 0.0 : result.point_scalars[point];
    // A missing value never compares equal: such a point stands for itself.
    representative[point] =
        std::isfinite(scalar) ? first.try_emplace({p[0], p[1], p[2], scalar}, point).first->second : point;
  }
  return representative;
}

bool has_values(const Tetrahedra& result, std::uint32_t cell, const std::vector<Polygon>& faces) {
  if (!result.cell_scalars.empty()) return std::isfinite(result.cell_scalars[cell]);
  for (const Polygon& face : faces)
    for (std::uint32_t point : face)
      if (!std::isfinite(result.point_scalars[point])) return false;
  return true;
}

/// Six times the volume over the cube of the longest edge from the first vertex: 0 for a flat tetrahedron.
double relative_volume(const Tetrahedra& result, const std::array<std::uint32_t, 4>& vertices) {
  double edge[3][3];
  double longest = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) edge[i][k] = result.points[vertices[i + 1]][k] - result.points[vertices[0]][k];
    longest = std::max(longest, std::hypot(edge[i][0], edge[i][1], edge[i][2]));
  }
  if (longest == 0.0) return 0.0;
  const double determinant = edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) -
                             edge[0][1] * (edge[1][0] * edge[2][2] - edge[1][2] * edge[2][0]) +
                             edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
  return std::abs(determinant) / (longest * longest * longest);
}

/// Appends the cone over the faces that do not hold the cell's lowest point.
void pull_cell(Tetrahedra& result, std::uint32_t cell, const std::vector<Polygon>& faces) {
  std::uint32_t apex = faces[0][0];
  for (const Polygon& face : faces) apex = std::min(apex, *std::min_element(face.begin(), face.end()));
  for (Polygon face : faces) {
    if (std::find(face.begin(), face.end(), apex) != face.end()) continue;
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const std::array<std::uint32_t, 4> vertices{apex, face[0], face[i], face[i + 1]};
      if (relative_volume(result, vertices) > 1e-14) result.cells.push_back({vertices, cell});
    }
  }
}

}  // namespace

Tetrahedra make_tetrahedra(const MeshData& mesh) {
  Tetrahedra result;
  result.points.resize(mesh.point_count());
  for (std::size_t point = 0; point < result.points.size(); ++point)
    for (int k = 0; k < 3; ++k) result.points[point][k] = mesh.points[3 * point + k];
  auto& scalars = mesh.association == Association::kPoint ? result.point_scalars : result.cell_scalars;
  scalars.assign(mesh.scalars.begin(), mesh.scalars.end());

  const std::vector<std::uint32_t> representative = first_of_coinciding(result);
  for (std::uint32_t cell = 0; cell < mesh.cell_count(); ++cell) {
    std::vector<Polygon> faces = cell_faces(mesh, cell);
    if (!has_values(result, cell, faces)) continue;
    for (Polygon& face : faces)
      for (std::uint32_t& point : face) point = representative[point];
    pull_cell(result, cell, faces);
  }
  return result;
}

}  // namespace tetravox::reference
