#pragma once

/// Meshes that are hard to sort, each in a few lines.

#include "src/mesh/builtin.h"
#include "tests/common/cameras.h"
#include "tests/common/mesh_builder.h"
#include "tetravox/mesh.h"
#include "tetravox/visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace tetravox::tests {

inline constexpr SortMethod kAllMethods[] = {SortMethod::kCentroid, SortMethod::kMpvo, SortMethod::kMpvonc,
                                             SortMethod::kXmpvo};

inline double any_field(const Vector3& p) { return p[0] + 0.3 * p[1] - 0.7 * p[2]; }

/// The mesh with every point moved by `move`.
inline MeshData move_points(const MeshData& mesh, const std::function<Vector3(const Vector3&)>& move) {
  MeshData moved = mesh;
  const auto points = std::make_shared<std::vector<double>>(mesh.points.begin(), mesh.points.end());
  for (std::size_t i = 0; i < points->size(); i += 3) {
    const Vector3 p = move({(*points)[i], (*points)[i + 1], (*points)[i + 2]});
    std::copy(p.begin(), p.end(), points->begin() + static_cast<std::ptrdiff_t>(i));
  }
  moved.points = *points;
  moved.storage =
      std::make_shared<std::pair<std::shared_ptr<const void>, std::shared_ptr<const void>>>(mesh.storage, points);
  return moved;
}

/// Turned about an axis that no face is parallel to, so that no coordinate stays a round number.
inline Vector3 turn_askew(const Vector3& p) {
  const double c = std::cos(0.7), s = std::sin(0.7), c2 = std::cos(0.4), s2 = std::sin(0.4);
  const Vector3 q{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
  return {q[0], c2 * q[1] - s2 * q[2], s2 * q[1] + c2 * q[2]};
}

inline MeshData make_porous_box(int bricks, double filled, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<bool> is_filled(static_cast<std::size_t>(bricks * bricks * bricks));
  std::bernoulli_distribution fill(filled);
  for (std::size_t i = 0; i < is_filled.size(); ++i) is_filled[i] = fill(random);
  BoxOptions options;
  options.bricks = {bricks, bricks, bricks};
  options.is_hole = [&](int i, int j, int k) {
    return !is_filled[static_cast<std::size_t>((k * bricks + j) * bricks + i)];
  };
  return make_box(options, any_field);
}

/// One tetrahedron in each of n^3 places, none touching another.
inline MeshData make_loose_tetrahedra(int n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0.02, 0.98);
  MeshBuilder builder;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        std::vector<std::uint32_t> ids;
        for (int corner = 0; corner < 4; ++corner)
          ids.push_back(builder.add_point({i + place(random), j + place(random), k + place(random)}, 0.1 * corner));
        builder.add_cell(CellType::kTetrahedron, ids);
      }
  return builder.build();
}

/// Two boxes that touch, with different bricks: no face of one fits a face of the other.
inline MeshData make_seam() {
  MeshBuilder builder;
  BoxOptions left, right;
  left.bricks = {3, 3, 3};
  left.upper = {0.1, 1, 1};
  right.bricks = {3, 4, 5};
  right.lower = {0.1, -1, -1};
  add_box(builder, left, any_field);
  add_box(builder, right, [](const Vector3& p) { return any_field(p) + 5.0; });
  return builder.build();
}

/// A box whose middle layer is so thin that its cells are flat once their points are floats.
inline MeshData make_flat_layer() {
  BoxOptions options;
  options.bricks = {3, 3, 3};
  const MeshData box = make_box(options, any_field);
  return move_points(box, [](const Vector3& p) {
    const double thin = 1e-12;
    return Vector3{p[0], p[1], p[2] < -0.5 ? -1.0 : p[2] < 0.0 ? 0.3 : p[2] < 0.5 ? 0.3 + thin : 1.0};
  });
}

/// A box of cells next to one of cells a hundred thousand times as small.
inline MeshData make_tiny_beside_large() {
  MeshBuilder builder;
  BoxOptions large, tiny;
  large.bricks = {2, 2, 2};
  tiny.bricks = {3, 3, 3};
  tiny.lower = {1.00001, 0.2, 0.1};
  tiny.upper = {1.00003, 0.20002, 0.10002};
  add_box(builder, large, any_field);
  add_box(builder, tiny, any_field);
  return builder.build();
}

/// `count` long tetrahedra in a circle, each over the next one as seen along z. Three are the least that can do so.
inline void add_ring(MeshBuilder& builder, int count, const Vector3& middle, double size) {
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    const Vector3 out{std::cos(angle), std::sin(angle), 0}, along{-std::sin(angle), std::cos(angle), 0};
    const auto at = [&](double a, double o, double z) {
      return builder.add_point({middle[0] + size * (a * along[0] + o * out[0]),
                                middle[1] + size * (a * along[1] + o * out[1]), middle[2] + size * z},
                               0.5 + z);
    };
    // The near end is high, the far end low; the ends of neighbours cross outside the circle.
    builder.add_cell(CellType::kTetrahedron,
                     {at(-2.5, 0.9, 0.6), at(-2.5, 1.1, 0.6), at(2.5, 1.0, -0.6), at(2.5, 1.0, -0.5)});
  }
}

inline MeshData make_ring() {
  MeshBuilder builder;
  add_ring(builder, 3, {0, 0, 0}, 1.0);
  return builder.build();
}

inline Camera look_along_z(const PreparedMesh& mesh, double distance) {
  Camera camera;
  for (int k = 0; k < 3; ++k) camera.focal_point[k] = 0.5 * (mesh.bounds[k].min + mesh.bounds[k].max);
  camera.position = camera.focal_point;
  camera.position[2] += distance;
  camera.view_up = {0, 1, 0};
  camera.view_angle = 50.0;
  return camera;
}

inline PreparedMesh prepare_builtin(const std::string& name, std::uint64_t cells) {
  for (const mesh::BuiltinMeshEntry& entry : mesh::builtin_meshes())
    if (entry.name == name) return prepare_mesh(mesh::make_builtin_mesh(entry, {cells, {}, {}}, name).mesh);
  ADD_FAILURE() << name;
  return {};
}

struct SortMesh {
  std::string name;
  PreparedMesh mesh;
  bool is_convex = false;
};

/// None of them has a cycle, seen from anywhere.
inline std::vector<SortMesh> make_acyclic_meshes() {
  BoxOptions box;
  box.bricks = {4, 3, 5};
  BoxOptions frame = box;
  frame.bricks = {5, 5, 5};
  frame.is_hole = [](int i, int j, int k) { return (i > 0 && i < 4 && j > 0 && j < 4) || (k == 2 && i == 0); };
  BoxOptions parts = box;
  parts.bricks = {7, 4, 4};
  parts.is_hole = [](int i, int j, int) { return i == 3 || (i == 5 && j != 1); };
  const auto prepare = [](const MeshData& mesh) { return prepare_mesh(mesh); };
  std::vector<SortMesh> meshes;
  meshes.push_back({"box", prepare(make_box(box, any_field)), true});
  meshes.push_back({"turned box", prepare(move_points(make_box(box, any_field), turn_askew)), true});
  meshes.push_back({"far box", prepare(transform_mesh(make_box(box, any_field), 1e-3, {1e6, -2e6, 3e5})), true});
  meshes.push_back({"frame", prepare(make_box(frame, any_field))});
  meshes.push_back({"parts", prepare(move_points(make_box(parts, any_field), turn_askew))});
  meshes.push_back({"porous", prepare(make_porous_box(8, 0.5, 1))});
  meshes.push_back({"turned porous", prepare(move_points(make_porous_box(7, 0.4, 2), turn_askew))});
  meshes.push_back({"loose", prepare(make_loose_tetrahedra(9, 3))});
  meshes.push_back({"seam", prepare(make_seam())});
  meshes.push_back({"turned seam", prepare(move_points(make_seam(), turn_askew))});
  meshes.push_back({"flat layer", prepare(make_flat_layer())});
  meshes.push_back({"turned flat layer", prepare(move_points(make_flat_layer(), turn_askew))});
  meshes.push_back({"tiny beside large", prepare(make_tiny_beside_large())});
  meshes.push_back({"sphere", prepare_builtin("sphere", 2560)});
  meshes.push_back({"buckyball", prepare_builtin("buckyball", 20000)});
  meshes.push_back({"duct", prepare_builtin("duct", 20000)});
  return meshes;
}

/// Those of every product test, along an axis of boxes, with the eye in the plane of faces and on a vertex.
inline std::vector<NamedCamera> make_sort_cameras(const PreparedMesh& mesh) {
  std::vector<NamedCamera> cameras = make_cameras(mesh.bounds);
  Camera axis = cameras[0].camera;
  const auto world = [&mesh](const Vertex& v) {
    return Vector3{mesh.origin[0] + v.x * mesh.world_per_local, mesh.origin[1] + v.y * mesh.world_per_local,
                   mesh.origin[2] + v.z * mesh.world_per_local};
  };
  const double size = mesh.world_per_local;
  axis.focal_point = mesh.origin;
  axis.position = {mesh.origin[0] + 5.0 * size, mesh.origin[1], mesh.origin[2]};
  cameras.push_back({"axis", axis});
  axis.parallel_scale = 1.2 * size;
  cameras.push_back({"orthographic axis", axis});
  Camera plane = cameras[0].camera;
  plane.position = world(mesh.vertices.front());
  plane.position[0] += 3.0 * size;
  plane.focal_point = mesh.origin;
  cameras.push_back({"in a plane", plane});
  Camera vertex = cameras[2].camera;
  vertex.position = world(mesh.vertices[mesh.vertices.size() / 2]);
  vertex.focal_point = {mesh.origin[0] + 0.031 * size, mesh.origin[1] + 0.017 * size, mesh.origin[2] - 0.011 * size};
  cameras.push_back({"on a vertex", vertex});
  return cameras;
}

inline OrderReport check(const PreparedMesh& mesh, const Camera& camera, std::span<const std::uint32_t> order,
                         int pixels = 48) {
  return check_order(mesh, camera, order, {SortDirection::kBackToFront, pixels, pixels, 0});
}

}  // namespace tetravox::tests
