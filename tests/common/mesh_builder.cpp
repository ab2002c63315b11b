#include "tests/common/mesh_builder.h"

#include <random>
#include <utility>

namespace tetravox::tests {
namespace {

/// What a built mesh owns.
struct Arrays {
  std::vector<double> points, scalars;
  std::vector<CellType> types;
  std::vector<std::uint64_t> offsets;
  std::vector<std::uint32_t> connectivity;
};

MeshData view_arrays(const std::shared_ptr<const Arrays>& arrays, Association association) {
  MeshData mesh;
  mesh.points = arrays->points;
  mesh.cell_types = arrays->types;
  mesh.cell_offsets = arrays->offsets;
  mesh.connectivity = arrays->connectivity;
  mesh.scalars = arrays->scalars;
  mesh.association = association;
  mesh.array_name = "field";
  mesh.storage = arrays;
  return mesh;
}

/// Eight corners of a brick in VTK's order of a hexahedron.
using Corners = std::array<std::uint32_t, 8>;

void add_brick(MeshBuilder& builder, CellType type, const Corners& c, const Vector3& middle, const Field& field,
               double scalar) {
  switch (type) {
    case CellType::kVoxel:
      builder.add_cell(type, {c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]}, scalar);
      break;
    case CellType::kWedge:
      builder.add_cell(type, {c[0], c[1], c[3], c[4], c[5], c[7]}, scalar);
      builder.add_cell(type, {c[1], c[2], c[3], c[5], c[6], c[7]}, scalar);
      break;
    case CellType::kPyramid: {
      const std::uint32_t tip = builder.add_point(middle, field(middle));
      const int bases[6][4] = {{0, 1, 2, 3}, {7, 6, 5, 4}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
      for (const auto& base : bases)
        builder.add_cell(type, {c[base[0]], c[base[1]], c[base[2]], c[base[3]], tip}, scalar);
      break;
    }
    case CellType::kTetrahedron: {
      // Kuhn's six tetrahedra about the diagonal 0-6 conform from brick to brick.
      const int paths[6][2] = {{1, 2}, {2, 3}, {3, 7}, {7, 4}, {4, 5}, {5, 1}};
      for (const auto& path : paths) builder.add_cell(type, {c[0], c[path[0]], c[path[1]], c[6]}, scalar);
      break;
    }
    case CellType::kPolyhedron:
      builder.add_cell(type,
                       {6, 4,    c[0], c[3], c[2], c[1], 4,    c[4], c[5], c[6], c[7], 4,    c[0], c[1], c[5], c[4],
                        4, c[1], c[2], c[6], c[5], 4,    c[2], c[3], c[7], c[6], 4,    c[3], c[0], c[4], c[7]},
                       scalar);
      break;
    default:
      builder.add_cell(CellType::kHexahedron, {c.begin(), c.end()}, scalar);
  }
}

}  // namespace

std::uint32_t MeshBuilder::add_point(const Vector3& position, double scalar) {
  points_.insert(points_.end(), position.begin(), position.end());
  point_scalars_.push_back(scalar);
  return point_count() - 1;
}

void MeshBuilder::add_cell(CellType type, const std::vector<std::uint32_t>& ids, double scalar) {
  types_.push_back(type);
  connectivity_.insert(connectivity_.end(), ids.begin(), ids.end());
  offsets_.push_back(connectivity_.size());
  cell_scalars_.push_back(scalar);
}

MeshData MeshBuilder::build(Association association) const {
  auto arrays = std::make_shared<Arrays>();
  arrays->points = points_;
  arrays->scalars = association == Association::kPoint ? point_scalars_ : cell_scalars_;
  arrays->types = types_;
  arrays->offsets = offsets_;
  arrays->connectivity = connectivity_;
  return view_arrays(arrays, association);
}

void add_box(MeshBuilder& builder, const BoxOptions& options, const Field& field) {
  const auto [nx, ny, nz] = options.bricks;
  const auto position = [&](double i, double j, double k) {
    const double index[3] = {i / nx, j / ny, k / nz};
    Vector3 p{};
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = options.lower[axis] + index[axis] * (options.upper[axis] - options.lower[axis]);
    return p;
  };
  const std::uint32_t first = builder.point_count();
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) builder.add_point(position(i, j, k), field(position(i, j, k)));
  const auto id = [&](int i, int j, int k) {
    return first + static_cast<std::uint32_t>(i + (nx + 1) * (j + (ny + 1) * k));
  };
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        if (options.is_hole && options.is_hole(i, j, k)) continue;
        const Corners corners = {id(i, j, k),     id(i + 1, j, k),     id(i + 1, j + 1, k),     id(i, j + 1, k),
                                 id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)};
        const Vector3 middle = position(i + 0.5, j + 0.5, k + 0.5);
        add_brick(builder, options.type, corners, middle, field, field(middle));
      }
    }
  }
}

MeshData make_box(const BoxOptions& options, const Field& field) {
  MeshBuilder builder;
  add_box(builder, options, field);
  return builder.build(options.association);
}

MeshData transform_mesh(const MeshData& mesh, double factor, const Vector3& centre) {
  auto arrays = std::make_shared<Arrays>();
  arrays->points.assign(mesh.points.begin(), mesh.points.end());
  for (std::size_t i = 0; i < arrays->points.size(); ++i)
    arrays->points[i] = centre[i % 3] + factor * arrays->points[i];
  arrays->scalars.assign(mesh.scalars.begin(), mesh.scalars.end());
  arrays->types.assign(mesh.cell_types.begin(), mesh.cell_types.end());
  arrays->offsets.assign(mesh.cell_offsets.begin(), mesh.cell_offsets.end());
  arrays->connectivity.assign(mesh.connectivity.begin(), mesh.connectivity.end());
  return view_arrays(arrays, mesh.association);
}

MeshData make_soup(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto draw = [&] { return static_cast<double>(random()) / 4294967295.0; };
  MeshBuilder builder;
  for (int cell = 0; cell < count; ++cell) {
    std::vector<std::uint32_t> ids;
    for (int corner = 0; corner < 4; ++corner) {
      const double x = 2.0 * draw() - 1.0, y = 2.0 * draw() - 1.0, z = 2.0 * draw() - 1.0;
      ids.push_back(builder.add_point({x, y, z}, draw()));
    }
    builder.add_cell(CellType::kTetrahedron, ids, draw());
  }
  return builder.build();
}

}  // namespace tetravox::tests
