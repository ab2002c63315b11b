/// Further fields of a mesh: frames, welding, missing values, memory.

#include "tests/unit/mesh/test_mesh.h"
#include "tetravox/error.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace tetravox::test {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// The block with fields beside its first one, which keep their values alive.
struct ManyFields {
  TestMesh mesh;
  std::vector<std::vector<double>> others;

  MeshData view() const {
    MeshData data = mesh.view();
    for (const std::vector<double>& other : others) data.others.push_back({other, "other", 0});
    return data;
  }
};

double value_of(const OtherScalars& other, std::size_t i) { return other.offset + other.scalars[i] * other.scale; }

ManyFields make_two_fields(std::uint32_t n) {
  ManyFields fields{make_block(n), {{}, {}}};
  for (std::size_t i = 0; i < fields.mesh.points.size(); i += 3) {
    const double* p = fields.mesh.points.data() + i;
    fields.others[0].push_back(1e6 + p[0]);
    fields.others[1].push_back(1e-6 * (p[1] - p[2]));
  }
  return fields;
}

TEST(OtherFields, FollowTheVerticesInFramesOfTheirOwn) {
  const PreparedMesh prepared = prepare_mesh(make_two_fields(5).view());
  ASSERT_EQ(prepared.others.size(), 2u);
  ASSERT_EQ(prepared.others[0].scalars.size(), prepared.vertices.size());
  for (std::uint32_t v = 0; v < prepared.vertices.size(); ++v) {
    const Point p = position(prepared, v);
    EXPECT_NEAR(value_of(prepared.others[0], v), 1e6 + p[0], 1e-4);
    EXPECT_NEAR(value_of(prepared.others[1], v), 1e-6 * (p[1] - p[2]), 1e-11);
  }
  EXPECT_DOUBLE_EQ(prepared.others[0].range.min, 1e6);
  EXPECT_DOUBLE_EQ(prepared.others[0].range.max, 1e6 + 5.0);
  EXPECT_DOUBLE_EQ(prepared.others[1].range.min, -5e-6);
}

TEST(OtherFields, OfCellsFollowTheTetrahedra) {
  TestMesh block = make_block(3);
  block.association = Association::kCell;
  block.scalars.clear();
  std::vector<double> other;
  for (std::size_t cell = 0; cell < block.types.size(); ++cell) {
    block.scalars.push_back(static_cast<double>(cell));
    other.push_back(1000.0 - static_cast<double>(cell));
  }
  const PreparedMesh prepared = prepare_mesh(ManyFields{block, {other}}.view());
  ASSERT_EQ(prepared.others.size(), 1u);
  ASSERT_EQ(prepared.others[0].scalars.size(), prepared.cells.size());
  for (std::size_t i = 0; i < prepared.cells.size(); ++i) {
    const double first = prepared.scalar_offset + prepared.cell_scalars[i] * prepared.scalar_scale;
    EXPECT_NEAR(value_of(prepared.others[0], i), 1000.0 - first, 1e-4);
  }
}

/// Two tetrahedra at a common face whose points are there twice.
ManyFields make_pair_of_cells() {
  ManyFields fields;
  for (const double apex : {-1.0, 1.0}) {
    std::vector<std::uint32_t> ids;
    for (const Point& p : {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}})
      ids.push_back(fields.mesh.add_point(p, 3.0));
    ids.push_back(fields.mesh.add_point({0, 0, apex}, apex));
    fields.mesh.add_cell(CellType::kTetrahedron, ids);
  }
  fields.others = {std::vector<double>(8, 7.0)};
  return fields;
}

TEST(OtherFields, PointsWeldOnlyWhereAllAgree) {
  ManyFields fields = make_pair_of_cells();
  EXPECT_EQ(prepare_mesh(fields.view()).vertices.size(), 5u);
  fields.others[0][5] = 8.0;
  const PreparedMesh prepared = prepare_mesh(fields.view());
  EXPECT_EQ(prepared.vertices.size(), 6u);
  EXPECT_EQ(prepared.report.merged_points, 2u);
  int count = 0;
  for (std::size_t v = 0; v < prepared.vertices.size(); ++v) count += value_of(prepared.others[0], v) == 8.0;
  EXPECT_EQ(count, 1);
}

TEST(OtherFields, AMissingValueOfAnyMakesTheCellTransparent) {
  ManyFields fields = make_pair_of_cells();
  fields.others.push_back(std::vector<double>(8, 0.0));
  fields.others[1][7] = kMissing;
  const PreparedMesh prepared = prepare_mesh(fields.view());
  EXPECT_EQ(prepared.cells.size(), 1u);
  EXPECT_EQ(prepared.report.missing_value_cells, 1u);
  fields.others[1][0] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(prepare_mesh(fields.view()), Error);
}

TEST(OtherFields, OfAnotherLengthAreRefused) {
  ManyFields fields = make_pair_of_cells();
  fields.others[0].pop_back();
  try {
    prepare_mesh(fields.view());
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("'other' has 7 values for 8 points"), std::string::npos) << error.what();
  }
}

TEST(OtherFields, CountAsMemory) {
  const ManyFields fields = make_two_fields(8);
  const std::uint64_t with = estimate_prepare_memory(fields.view()).resident;
  EXPECT_EQ(with, estimate_prepare_memory(fields.mesh.view()).resident + 2 * sizeof(float) * 9 * 9 * 9);
}

}  // namespace
}  // namespace tetravox::test
