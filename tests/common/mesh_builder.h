#pragma once

/// Small meshes made in tests.

#include "tetravox/camera.h"
#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace tetravox::tests {

using Field = std::function<double(const Vector3&)>;

/// Collects points and cells, then hands them over as `MeshData`.
class MeshBuilder {
 public:
  /// Id of the new point. With cell data `scalar` is not used.
  std::uint32_t add_point(const Vector3& position, double scalar = 0.0);
  /// `ids` in VTK's order. `scalar` is used with cell data only.
  void add_cell(CellType type, const std::vector<std::uint32_t>& ids, double scalar = 0.0);

  std::uint32_t point_count() const { return static_cast<std::uint32_t>(points_.size() / 3); }
  /// The mesh so far; it owns a copy of everything.
  MeshData build(Association association = Association::kPoint) const;

 private:
  std::vector<double> points_, point_scalars_, cell_scalars_;
  std::vector<CellType> types_;
  std::vector<std::uint64_t> offsets_{0};
  std::vector<std::uint32_t> connectivity_;
};

/// A box of nx * ny * nz bricks, each made of cells of one kind.
struct BoxOptions {
  std::array<int, 3> bricks{4, 4, 4};
  Vector3 lower{-1, -1, -1};
  Vector3 upper{1, 1, 1};
  /// kHexahedron, kVoxel, kWedge (two a brick), kPyramid (six about the brick's centre), kTetrahedron (six), or
  /// kPolyhedron (a brick with six quadrilaterals).
  CellType type = CellType::kHexahedron;
  Association association = Association::kPoint;
  /// Bricks that are left out (holes, steps in the outline): by brick number.
  std::function<bool(int, int, int)> is_hole;
};

/// Fills `builder` with a box: with point data `field` at the points, with cell data at each brick's centre.
void add_box(MeshBuilder& builder, const BoxOptions& options, const Field& field);
/// A mesh that is one such box.
MeshData make_box(const BoxOptions& options, const Field& field);

/// The mesh with every point at centre + factor * p.
MeshData transform_mesh(const MeshData& mesh, double factor, const Vector3& centre);

/// `count` tetrahedra with corners at random in [-1, 1]^3 and values in [0, 1]: they overlap wildly.
MeshData make_soup(int count, std::uint32_t seed);

}  // namespace tetravox::tests
