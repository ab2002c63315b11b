/// Meshes with faults: what can be drawn is drawn and counted, the rest is a clear error.

#include "tests/unit/mesh/test_mesh.h"
#include "tetravox/error.h"

#include <functional>
#include <limits>
#include <random>
#include <string>

namespace tetravox::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Prepares; expects an error of this code whose message has one line and contains `text`.
void expect_error(const MeshData& mesh, ErrorCode code, const std::string& text) {
  try {
    prepare_mesh(mesh);
    ADD_FAILURE() << "no error about '" << text << "'";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(Damaged, DegenerateCellsAreLeftOut) {
  TestMesh mesh;
  add_tetrahedron(mesh);
  mesh.add_point({1, 1, 0});
  mesh.add_cell(CellType::kTetrahedron, {0, 1, 2, 4});  // flat
  mesh.add_cell(CellType::kTetrahedron, {0, 1, 1, 3});  // a point twice
  mesh.add_cell(CellType::kTetrahedron, {2, 2, 2, 2});
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.degenerate, 3u);
  EXPECT_EQ(prepared.cells.size(), 1u);
  EXPECT_EQ(prepared.vertices.size(), 4u);  // the flat cell's own point is gone
  EXPECT_EQ(prepared.bounds[0].max, 1.0);
  recover_cells(prepared);
}

TEST(Damaged, CoincidentPointsWithDifferentValuesMakeNoCell) {
  TestMesh mesh;
  add_tetrahedron(mesh);
  mesh.add_point({0.1, 0.2, 0.3}, 1.0);
  mesh.add_point({0.1, 0.2, 0.3}, 2.0);
  mesh.add_cell(CellType::kTetrahedron, {0, 1, 4, 5});
  EXPECT_EQ(prepare_mesh(mesh.view()).report.degenerate, 1u);
}

TEST(Damaged, RepeatedCellsAreDrawnOnce) {
  TestMesh mesh;
  for (int i = 0; i < 20; ++i) add_tetrahedron(mesh, 2.0 * i, 10.0 * i);
  std::mt19937 random(6);
  for (int i = 0; i < 30; ++i) {
    std::vector<std::uint32_t> ids = {0, 1, 2, 3};
    for (std::uint32_t& id : ids) id += 4u * static_cast<std::uint32_t>(i % 15);
    std::shuffle(ids.begin(), ids.end(), random);
    mesh.add_cell(CellType::kTetrahedron, ids);
  }
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.duplicated, 30u);
  EXPECT_EQ(prepared.cells.size(), 20u);
  EXPECT_EQ(prepared.boundary.size(), 80u);
  recover_cells(prepared);
}

TEST(Damaged, TheFirstOfRepeatedCellsGivesItsValue) {
  TestMesh mesh;
  mesh.association = Association::kCell;
  for (const double x : {0.0, 1.0}) mesh.add_point({x, 0, 0});
  mesh.add_point({0, 1, 0});
  mesh.add_point({0, 0, 1});
  for (int i = 0; i < 50; ++i) mesh.add_cell(CellType::kTetrahedron, {0, 1, 2, 3});
  for (int i = 0; i < 50; ++i) mesh.scalars.push_back(7.0 + i);
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.duplicated, 49u);
  EXPECT_EQ(prepared.scalar_range.max, 7.0);
}

TEST(Damaged, InvertedCellsAreOriented) {
  TestMesh mesh = make_block(3);
  for (std::size_t cell = 0; cell < 27; cell += 2)  // turn every other hexahedron inside out
    std::rotate(mesh.connectivity.begin() + static_cast<long>(8 * cell),
                mesh.connectivity.begin() + static_cast<long>(8 * cell + 4),
                mesh.connectivity.begin() + static_cast<long>(8 * cell + 8));
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.boundary.size(), 12u * 9);
  EXPECT_NEAR(boundary_area(prepared), 54.0, 1e-4);
}

TEST(Damaged, ThreeCellsOnOneFace) {
  TestMesh mesh;
  add_tetrahedron(mesh);
  mesh.add_point({0.2, 0.2, -1});
  mesh.add_point({0.2, 0.2, -2});
  mesh.add_cell(CellType::kTetrahedron, {0, 1, 2, 4});
  mesh.add_cell(CellType::kTetrahedron, {0, 1, 2, 5});
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.overlapping_faces, 1u);
  EXPECT_EQ(prepared.cells.size(), 3u);
  EXPECT_EQ(prepared.boundary.size(), 12u);
  recover_cells(prepared);
}

TEST(Damaged, TwoCellsOnOneSideOfAFace) {
  TestMesh mesh;
  add_tetrahedron(mesh);
  mesh.add_point({0.2, 0.2, 0.5});
  mesh.add_cell(CellType::kTetrahedron, {0, 1, 2, 4});
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.overlapping_faces, 1u);
  EXPECT_EQ(prepared.boundary.size(), 8u);
}

TEST(Damaged, MissingPointValuesRemoveCellsAndNothingElse) {
  TestMesh mesh = make_block(4);
  mesh.scalars[2 * 25 + 2 * 5 + 2] = kNan;  // the point in the middle, of eight cells
  PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.missing_value_cells, 8u);
  EXPECT_NEAR(total_volume(prepared), 64.0 - 8.0, 1e-3);
  EXPECT_NEAR(boundary_area(prepared), 6.0 * 16 + 6.0 * 4, 1e-3);
  for (const Vertex& v : prepared.vertices) EXPECT_TRUE(std::isfinite(v.scalar));
  mesh.scalars[0] = -kInfinity;  // a corner, of one cell
  prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.missing_value_cells, 9u);
  EXPECT_EQ(prepared.scalar_range.min, 1.0);
}

TEST(Damaged, MissingCellValues) {
  TestMesh mesh = make_block(3);
  mesh.association = Association::kCell;
  mesh.scalars.assign(27, 5.0);
  mesh.scalars[13] = kNan;
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.missing_value_cells, 1u);
  EXPECT_EQ(prepared.boundary.size(), 12u * 9 + 12);
  EXPECT_EQ(prepared.scalar_range.min, 5.0);
  EXPECT_EQ(prepared.scalar_range.max, 5.0);
}

TEST(Damaged, NothingLeftSaysWhy) {
  TestMesh mesh = make_block(2);
  mesh.scalars.assign(27, kNan);
  expect_error(mesh.view(), ErrorCode::kNothingToDraw, "all 8 cells have missing values");
  TestMesh flat = make_block(2);
  for (std::size_t i = 2; i < flat.points.size(); i += 3) flat.points[i] = 4.0;
  expect_error(flat.view(), ErrorCode::kNothingToDraw, "have no volume");
  expect_error(TestMesh{}.view(), ErrorCode::kNothingToDraw, "no cells");
  expect_error(MeshData{}, ErrorCode::kNothingToDraw, "no cells");
}

TEST(Damaged, InvalidIdsAndOffsets) {
  const auto expect_after = [](const std::function<void(TestMesh&)>& damage, const std::string& text) {
    TestMesh mesh = make_block(2);
    damage(mesh);
    estimate_prepare_memory(mesh.view());
    expect_error(mesh.view(), ErrorCode::kBadFile, text);
  };
  expect_after([](TestMesh& m) { m.connectivity[8 * 5 + 3] = 27; }, "cell 5 (hexahedron) uses point 27 of 27");
  expect_after([](TestMesh& m) { m.connectivity[8 * 5 + 3] = kNoCell; }, "cell 5");
  expect_after([](TestMesh& m) { m.offsets[3] = 1000; }, "cell 2");
  expect_after([](TestMesh& m) { m.offsets[3] = ~0ull; }, "cell 2");
  expect_after([](TestMesh& m) { m.offsets.back() = 65; }, "cell 7");
  expect_after([](TestMesh& m) { m.offsets[4] = 31; }, "cell 3 (hexahedron) has 7 points where 8 are needed");
  expect_after([](TestMesh& m) { m.offsets.pop_back(); }, "cell offsets");
  expect_after([](TestMesh& m) { m.offsets.clear(); }, "cell offsets");
  expect_after([](TestMesh& m) { m.points.pop_back(); }, "points");
  expect_after([](TestMesh& m) { m.scalars.pop_back(); }, "array 'field' has 26 values for 27 points");
  expect_after([](TestMesh& m) { m.association = Association::kCell; }, "27 values for 8 cells");
  expect_after([](TestMesh& m) { m.points[3 * 14 + 1] = kNan; }, "point 14");
  expect_after([](TestMesh& m) { m.points[3 * 14 + 1] = kInfinity; }, "point 14");
  TestMesh unknown = make_block(2);
  unknown.types[6] = static_cast<CellType>(9);
  expect_error(unknown.view(), ErrorCode::kUnsupported, "cell 6 (cell type 9)");
}

TEST(Damaged, PolyhedronStreams) {
  const auto expect_stream = [](const std::vector<std::uint32_t>& stream, const std::string& text) {
    TestMesh mesh;
    add_tetrahedron(mesh);
    mesh.add_cell(CellType::kPolyhedron, stream);
    estimate_prepare_memory(mesh.view());
    expect_error(mesh.view(), ErrorCode::kBadFile, text);
  };
  expect_stream({}, "face stream");
  expect_stream({0xFFFFFFFFu}, "face stream");
  expect_stream({1, 0xFFFFFFFFu, 0, 1, 2}, "face stream");
  expect_stream({2, 3, 0, 1, 2}, "face stream");
  expect_stream({1, 3, 0, 1, 2, 3}, "face stream");
  expect_stream({1, 2, 0, 1}, "face stream");
  expect_stream({1, 3, 0, 1, 99}, "uses point 99 of 4");
}

TEST(Damaged, UnusedPointsMayBeAnything) {
  TestMesh mesh;
  mesh.add_point({kNan, kInfinity, 0}, kNan);
  add_tetrahedron(mesh);
  mesh.add_point({1e300, 0, 0}, 1e300);
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.vertices.size(), 4u);
  EXPECT_EQ(prepared.bounds[0].max, 1.0);
  EXPECT_EQ(prepared.scalar_range.max, 3.0);
}

TEST(Damaged, SeamsWithDoubledPointsAreClosed) {
  // Two blocks of hexahedra side by side, each with its own points, the second in the opposite order, and -0 for 0.
  TestMesh mesh = make_block(3);
  const TestMesh block = make_block(3);
  const std::uint32_t first = 64;
  for (std::uint32_t p = 0; p < 64; ++p) {
    const double* q = block.points.data() + 3 * (63 - p);
    mesh.add_point({q[0] + 3, q[1] == 0 ? -0.0 : q[1], q[2]}, block.scalars[63 - p] + 3);
  }
  for (std::size_t cell = 0; cell < 27; ++cell) {
    std::vector<std::uint32_t> ids;
    for (std::size_t i = 0; i < 8; ++i) ids.push_back(first + 63 - block.connectivity[8 * cell + i]);
    mesh.add_cell(CellType::kHexahedron, ids);
  }
  PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.report.merged_points, 16u);
  EXPECT_NEAR(boundary_area(prepared), 2 * 9 + 4 * 18, 1e-4);

  // With other values the points stay apart and the seam is boundary on both sides; it is split alike nevertheless.
  TestMesh step = mesh;
  for (std::size_t p = 64; p < 128; ++p) step.scalars[p] += 1000.0;
  prepared = prepare_mesh(step.view());
  EXPECT_EQ(prepared.report.merged_points, 0u);
  EXPECT_NEAR(boundary_area(prepared), 2 * 9 + 4 * 18 + 2 * 9, 1e-4);
  std::map<std::array<Point, 3>, int> seam;
  for (const BoundaryFace& face : prepared.boundary) {
    std::array<Point, 3> corners;
    for (int i = 0; i < 3; ++i) corners[i] = position(prepared, face.vertices[i]);
    std::sort(corners.begin(), corners.end());
    if (corners[0][0] == 3 && corners[1][0] == 3 && corners[2][0] == 3) ++seam[corners];
  }
  EXPECT_EQ(seam.size(), 18u);
  for (const auto& [corners, count] : seam) EXPECT_EQ(count, 2);

  // With cell data all coincident points are one.
  TestMesh cells = step;
  cells.association = Association::kCell;
  cells.scalars.assign(54, 1.0);
  prepared = prepare_mesh(cells.view());
  EXPECT_EQ(prepared.report.merged_points, 16u);
  EXPECT_NEAR(boundary_area(prepared), 2 * 9 + 4 * 18, 1e-4);
}

TEST(Damaged, ManyCellsAroundOneVertexOrFace) {
  // A fan of cells around an edge, and as many cells on one face: no more than slow.
  TestMesh mesh;
  mesh.add_point({0, 0, 0});
  mesh.add_point({0, 0, 1});
  constexpr std::uint32_t kCells = 20000;
  for (std::uint32_t i = 0; i < kCells; ++i) {
    const double angle = 6.283185307179586 * i / kCells;
    mesh.add_point({std::cos(angle), std::sin(angle), 0.5}, i);
  }
  for (std::uint32_t i = 0; i < kCells; ++i) mesh.add_cell(CellType::kTetrahedron, {0, 1, 2 + i, 2 + (i + 1) % kCells});
  for (std::uint32_t i = 10; i < kCells; ++i) mesh.add_cell(CellType::kTetrahedron, {0, 2, 5, 2 + i});
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_GE(prepared.cells.size(), std::size_t{kCells});
  EXPECT_GE(prepared.report.overlapping_faces, 1u);
  recover_cells(prepared);
}

TEST(Damaged, RandomMeshesNeverCrash) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 300; ++trial) {
    TestMesh mesh;
    std::uniform_int_distribution<std::uint32_t> id(0, 11);
    for (int p = 0; p < 12; ++p)
      mesh.add_point({double(random() % 4), double(random() % 4), double(random() % 4)}, double(random() % 3));
    for (int cell = 0; cell < 30; ++cell) {
      const CellType types[] = {CellType::kTetrahedron, CellType::kHexahedron,           CellType::kWedge,
                                CellType::kPyramid,     CellType::kQuadraticTetrahedron, CellType::kQuadraticPyramid};
      std::vector<std::uint32_t> ids(13);
      for (std::uint32_t& i : ids) i = id(random);
      mesh.add_cell(types[random() % 6], ids);
    }
    recover_cells(prepare_mesh(mesh.view()));
  }
}

}  // namespace
}  // namespace tetravox::test
