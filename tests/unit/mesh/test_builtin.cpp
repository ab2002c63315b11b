#include "tests/unit/mesh/test_mesh.h"
#include "tetravox/error.h"

#include <numbers>
#include <string>

namespace tetravox::test {
namespace {

void expect_clean(const PreparedMesh& mesh) {
  EXPECT_EQ(mesh.report.degenerate, 0u);
  EXPECT_EQ(mesh.report.duplicated, 0u);
  EXPECT_EQ(mesh.report.overlapping_faces, 0u);
  EXPECT_EQ(mesh.report.merged_points, 0u);
  expect_closed_boundary(mesh);
}

TEST(Builtin, SphereIsABall) {
  const Dataset dataset = make_embedded("sphere");
  const PreparedMesh mesh = prepare_mesh(dataset.mesh);
  EXPECT_EQ(mesh.cells.size(), 2560u);
  expect_clean(mesh);
  EXPECT_EQ(mesh.boundary.size(), 12u * 64);
  EXPECT_EQ(boundary_euler(mesh), 2);
  EXPECT_NEAR(total_volume(mesh), 4.0 / 3.0 * std::numbers::pi, 0.1);
  for (const BoundaryFace& face : mesh.boundary)
    for (const std::uint32_t vertex : face.vertices) {
      const Point p = position(mesh, vertex);
      EXPECT_NEAR(dot(p, p), 1.0, 1e-6);
    }
  EXPECT_EQ(mesh.scalar_range.min, 0.0);
  EXPECT_NEAR(mesh.scalar_range.max, 1.0, 1e-12);
  EXPECT_NEAR(total_volume(prepare_mesh(make_embedded("sphere", 200000).mesh)), 4.0 / 3.0 * std::numbers::pi, 0.005);
}

TEST(Builtin, BuckyballHasSixtyAtoms) {
  const Dataset dataset = make_embedded("buckyball", 1500000);
  const std::size_t row = 64;
  ASSERT_EQ(dataset.mesh.point_count(), row * row * row);
  const auto value = [&](std::size_t i, std::size_t j, std::size_t k) {
    return dataset.mesh.scalars[(k * row + j) * row + i];
  };
  int maxima = 0;
  for (std::size_t k = 1; k + 1 < row; ++k)
    for (std::size_t j = 1; j + 1 < row; ++j)
      for (std::size_t i = 1; i + 1 < row; ++i) {
        bool is_maximum = value(i, j, k) > 0.5;
        for (std::size_t n = 0; n < 27 && is_maximum; ++n)
          if (n != 13) is_maximum = value(i, j, k) >= value(i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1);
        maxima += is_maximum;
      }
  // Neighbouring lattice points may tie by symmetry.
  EXPECT_GE(maxima, 60);
  EXPECT_LE(maxima, 72);
}

TEST(Builtin, BuckyballIsClean) {
  const Dataset dataset = make_embedded("buckyball");
  const PreparedMesh mesh = prepare_mesh(dataset.mesh);
  EXPECT_EQ(mesh.cells.size(), 178746u);
  expect_clean(mesh);
  EXPECT_NEAR(total_volume(mesh), 8.0, 1e-4);
  EXPECT_EQ(mesh.boundary.size(), 12u * 31 * 31);
}

TEST(Builtin, DuctIsCleanWithOneHole) {
  const Dataset dataset = make_embedded("duct");
  EXPECT_GT(dataset.info.cell_count, 20000u);
  EXPECT_LT(dataset.info.cell_count, 60000u);
  const PreparedMesh mesh = prepare_mesh(dataset.mesh);
  EXPECT_EQ(mesh.cells.size(), 6 * dataset.info.cell_count);
  expect_clean(mesh);
  EXPECT_EQ(boundary_euler(mesh), 0);  // a torus
  boundary_area(mesh);
}

TEST(Builtin, DuctHasCellData) {
  const Dataset dataset = make_embedded("duct", 0, "volume");
  EXPECT_EQ(dataset.mesh.association, Association::kCell);
  const PreparedMesh mesh = prepare_mesh(dataset.mesh);
  double volume = 0.0;
  for (const double v : dataset.mesh.scalars) {
    EXPECT_GT(v, 0.0);
    volume += v;
  }
  EXPECT_NEAR(volume, total_volume(mesh), 0.01);
  EXPECT_EQ(make_embedded("duct", 0, "speed").mesh.array_name, "speed");
  EXPECT_THROW(make_embedded("duct", 0, "temperature"), Error);
}

TEST(Builtin, InfoIsComplete) {
  for (const mesh::BuiltinMeshEntry& entry : mesh::builtin_meshes()) {
    const Dataset dataset = make_embedded(entry.name);
    const DatasetInfo& info = dataset.info;
    EXPECT_FALSE(entry.description.empty());
    EXPECT_EQ(info.source, entry.name);
    EXPECT_FALSE(dataset.is_grid());
    EXPECT_EQ(info.format, "embedded");
    EXPECT_EQ(info.cell_count, dataset.mesh.cell_count());
    EXPECT_EQ(info.point_count, dataset.mesh.point_count());
    ASSERT_EQ(info.cells_by_type.size(), 1u);
    EXPECT_EQ(info.cells_by_type[0].second, info.cell_count);
    const PreparedMesh mesh = prepare_mesh(dataset.mesh);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(info.bounds[axis].min, mesh.bounds[axis].min);
      EXPECT_EQ(info.bounds[axis].max, mesh.bounds[axis].max);
    }
    const ArrayInfo& array = info.arrays[choose_array(info, {})];
    EXPECT_EQ(array.name, dataset.mesh.array_name);
    EXPECT_EQ(array.component_ranges.at(0).min, mesh.scalar_range.min);
    EXPECT_EQ(array.magnitude_range.max, mesh.scalar_range.max);
  }
}

TEST(Builtin, SizesAreMet) {
  for (const mesh::BuiltinMeshEntry& entry : mesh::builtin_meshes()) {
    for (const std::uint64_t cells : {10'000, 100'000, 1'000'000}) {
      const auto made = static_cast<double>(make_embedded(entry.name, cells).info.cell_count);
      EXPECT_GT(made, 0.6 * static_cast<double>(cells)) << entry.name;
      EXPECT_LT(made, 1.6 * static_cast<double>(cells)) << entry.name;
    }
    prepare_mesh(make_embedded(entry.name, mesh::kFewestCells).mesh);
  }
}

}  // namespace
}  // namespace tetravox::test
