#include "src/scene/eye_cells.h"

#include "src/support/threads.h"

#include <tbb/concurrent_vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tetravox::scene {
namespace {

/// An eye nearer than this to a face of its cell is moved away from it, and by how far; local units, some ulps of
/// float.
constexpr double kTooNear = 1e-6;
constexpr double kStep = 4e-6;

Vector3 operator-(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vector3& a) { return std::sqrt(dot(a, a)); }

Vector3 vertex_position(const SeenMesh& mesh, std::uint32_t id) {
  const float* v = mesh.vertices + 4 * static_cast<std::size_t>(id);
  return {v[0], v[1], v[2]};
}

/// A vertex relative to the line through the eye along the view.
struct Corner {
  std::uint32_t id = 0;
  double x = 0.0, y = 0.0, z = 0.0;
};

Corner make_corner(const SeenMesh& mesh, const CameraFrame& frame, std::uint32_t id) {
  const Vector3 p = vertex_position(mesh, id) - frame.eye;
  return {id, p[0], p[1], p[2]};
}

double product(const Corner& a, const Corner& b) { return a.x * b.y - a.y * b.x; }

/// Whether the line passes on the inner side of an edge; ties as in the kernels (passes_tie).
bool passes_inside(const Corner& a, const Corner& b) {
  const double p = product(a, b);
  return p > 0.0 || (p == 0.0 && (b.y < a.y || (b.y == a.y && b.x > a.x)));
}

/// Depth at which the line meets a triangle that holds it.
double depth_in(const std::array<Corner, 3>& t) {
  const std::array<double, 3> weight{product(t[1], t[2]), product(t[2], t[0]), product(t[0], t[1])};
  const double total = weight[0] + weight[1] + weight[2];
  return total > 0.0 ? (weight[0] * t[0].z + weight[1] * t[1].z + weight[2] * t[2].z) / total : t[0].z;
}

using Cell = std::array<std::uint32_t, 4>;  // vertices: the face that the line enters through, and the one opposite

struct EyeCell {
  std::uint32_t cell = kNoCell;
  Cell vertices{};
};

/// Walks from the cell behind `face` until the eye is passed; what is found holds the eye.
void walk_to_eye(const SeenMesh& mesh, const CameraFrame& frame, std::array<Corner, 3> face, std::uint32_t cell,
                 std::size_t cell_count, tbb::concurrent_vector<EyeCell>& found) {
  for (std::size_t step = 0; step <= cell_count && cell != kNoCell; ++step) {
    const TetrahedronLinks& links = mesh.cells[cell];
    const std::uint32_t id = links.vertex_xor ^ face[0].id ^ face[1].id ^ face[2].id;
    if (id > mesh.last_vertex) return;
    const Corner d = make_corner(mesh, frame, id);
    std::array<bool, 3> positive{};
    for (int k = 0; k < 3; ++k) positive[k] = passes_inside(face[k], d);
    const int out = positive[2] && !positive[1] ? 0 : (positive[1] && !positive[0] ? 2 : 1);

    const Cell vertices{face[0].id, face[1].id, face[2].id, id};
    const std::uint32_t replaced = face[out].id;
    int rank = 0;
    for (const std::uint32_t vertex : vertices) rank += vertex < replaced;
    face[out] = d;
    if (depth_in(face) >= 0.0) {
      found.push_back({cell, vertices});
      return;
    }
    cell = links.neighbours[rank];
  }
}

/// The cells that hold the eye, in a fixed order, each once.
std::vector<EyeCell> find_eye_cells(const SeenMesh& mesh, std::span<const BoundaryFace> boundary,
                                    std::size_t cell_count, const CameraFrame& frame) {
  tbb::concurrent_vector<EyeCell> found;
  support::parallel_chunks(boundary.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::array<Corner, 3> face{};
      for (int k = 0; k < 3; ++k) face[k] = make_corner(mesh, frame, boundary[i].vertices[k]);
      const bool entered =
          passes_inside(face[0], face[1]) && passes_inside(face[1], face[2]) && passes_inside(face[2], face[0]);
      if (entered && depth_in(face) < 0.0) walk_to_eye(mesh, frame, face, boundary[i].cell, cell_count, found);
    }
  });
  std::vector<EyeCell> cells(found.begin(), found.end());
  std::sort(cells.begin(), cells.end(), [](const EyeCell& a, const EyeCell& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.vertices < b.vertices;
  });
  cells.erase(
      std::unique(cells.begin(), cells.end(), [](const EyeCell& a, const EyeCell& b) { return a.cell == b.cell; }),
      cells.end());
  return cells;
}

/// Distance from a point to a triangle where it is below `limit`; otherwise some number that is not.
double distance_to_triangle(const Vector3& p, const std::array<Vector3, 3>& t, double limit) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    if (p[axis] < low - limit || p[axis] > high + limit) return limit;
  }
  const Vector3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double size = length(normal);
  if (!(size > 0.0)) return limit;
  const double height = std::abs(dot(normal, p - t[0])) / size;
  for (int k = 0; k < 3; ++k) {
    const Vector3 edge = t[(k + 1) % 3] - t[k];
    const double outside = -dot(cross(normal, edge), p - t[k]) / (size * std::max(length(edge), 1e-30));
    if (outside > limit) return limit;
  }
  return height;
}

/// Moves the eye towards the middle of a tetrahedron.
void move_eye_into(const SeenMesh& mesh, const Cell& vertices, CameraFrame& frame) {
  Vector3 middle{};
  for (const std::uint32_t id : vertices)
    for (int axis = 0; axis < 3; ++axis) middle[axis] += 0.25 * vertex_position(mesh, id)[axis];
  const Vector3 way = middle - frame.eye;
  const double share = std::min(0.5, kStep / std::max(length(way), 1e-30));
  for (int axis = 0; axis < 3; ++axis) frame.eye[axis] += share * way[axis];
}

/// Moves an eye on the skin of the mesh inside.
void leave_boundary(const SeenMesh& mesh, std::span<const BoundaryFace> boundary, CameraFrame& frame) {
  for (const BoundaryFace& face : boundary) {
    std::array<Vector3, 3> corners{};
    for (int k = 0; k < 3; ++k) corners[k] = vertex_position(mesh, face.vertices[k]);
    if (distance_to_triangle(frame.eye, corners, kTooNear) >= kTooNear) continue;
    const auto& v = face.vertices;
    move_eye_into(mesh, {v[0], v[1], v[2], mesh.cells[face.cell].vertex_xor ^ v[0] ^ v[1] ^ v[2]}, frame);
    return;
  }
}

/// Whether the eye is nearly on a face of the tetrahedron.
bool is_on_face(const SeenMesh& mesh, const Cell& vertices, const CameraFrame& frame) {
  for (int k = 0; k < 4; ++k) {
    const std::array<Vector3, 3> corners{vertex_position(mesh, vertices[(k + 1) % 4]),
                                         vertex_position(mesh, vertices[(k + 2) % 4]),
                                         vertex_position(mesh, vertices[(k + 3) % 4])};
    if (distance_to_triangle(frame.eye, corners, kTooNear) < kTooNear) return true;
  }
  return false;
}

}  // namespace

std::vector<BoundaryFace> find_eye_cell_faces(const SeenMesh& mesh, std::span<const BoundaryFace> boundary,
                                              std::size_t cell_count, CameraFrame& frame) {
  if (frame.is_orthographic) return {};
  leave_boundary(mesh, boundary, frame);
  std::vector<EyeCell> cells = find_eye_cells(mesh, boundary, cell_count, frame);
  if (!cells.empty() && is_on_face(mesh, cells.front().vertices, frame)) {
    move_eye_into(mesh, cells.front().vertices, frame);
    cells = find_eye_cells(mesh, boundary, cell_count, frame);
  }
  std::vector<BoundaryFace> faces;
  for (const auto& [cell, v] : cells)
    faces.insert(faces.end(), {BoundaryFace{cell, {v[0], v[1], v[2]}}, BoundaryFace{cell, {v[1], v[0], v[3]}},
                               BoundaryFace{cell, {v[2], v[1], v[3]}}, BoundaryFace{cell, {v[0], v[2], v[3]}}});
  return faces;
}

bool reaches_behind_eye(const SeenMesh& mesh, const CameraFrame& frame, bool is_in_cell) {
  if (!frame.is_orthographic) return is_in_cell;
  for (std::size_t i = 0; i <= mesh.last_vertex; ++i)
    if (mesh.vertices[4 * i + 2] < frame.eye[2]) return true;
  return false;
}

}  // namespace tetravox::scene
