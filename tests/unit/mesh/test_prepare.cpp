/// Neighbours, boundary, order, determinism and cancelling of `prepare_mesh`.

#include "src/support/threads.h"
#include "tests/unit/mesh/test_mesh.h"
#include "tetravox/error.h"

#include <atomic>
#include <cstring>
#include <random>
#include <set>
#include <string>

namespace tetravox::test {
namespace {

template <class T>
bool is_same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Calls prepare_mesh with at most `threads` threads.
PreparedMesh prepare_with_threads(const MeshData& mesh, int threads) {
  PreparedMesh prepared;
  support::with_threads(threads, [&] { prepared = prepare_mesh(mesh); });
  return prepared;
}

TEST(Prepare, BlockHasItsSkinAsBoundary) {
  for (const CellType type : {CellType::kHexahedron, CellType::kVoxel}) {
    const std::uint32_t n = 7;
    const PreparedMesh mesh = prepare_mesh(make_block(n, type).view());
    EXPECT_EQ(mesh.cells.size(), 6u * n * n * n);
    EXPECT_EQ(mesh.vertices.size(), (n + 1) * (n + 1) * (n + 1));
    EXPECT_EQ(mesh.boundary.size(), 12u * n * n);
    EXPECT_NEAR(total_volume(mesh), n * n * n, 1e-3);
    EXPECT_NEAR(boundary_area(mesh), 6.0 * n * n, 1e-3);
    EXPECT_EQ(boundary_euler(mesh), 2);
    expect_closed_boundary(mesh);
    EXPECT_EQ(mesh.report.input_cells, n * n * n);
    EXPECT_EQ(mesh.report.merged_points + mesh.report.degenerate + mesh.report.duplicated, 0u);
    for (const ValueRange& range : mesh.bounds) {
      EXPECT_EQ(range.min, 0.0);
      EXPECT_EQ(range.max, n);
    }
  }
}

TEST(Prepare, HoleIsBoundaryToo) {
  // A block of 3^3 cells without the one in the middle.
  TestMesh mesh = make_block(3);
  mesh.types.erase(mesh.types.begin() + 13);
  mesh.connectivity.erase(mesh.connectivity.begin() + 8 * 13, mesh.connectivity.begin() + 8 * 14);
  mesh.offsets.pop_back();
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.boundary.size(), 12u * 9 + 12u);
  EXPECT_EQ(boundary_euler(prepared), 4);
  EXPECT_NEAR(total_volume(prepared), 26.0, 1e-4);
}

TEST(Prepare, BoundaryIsInOrderOfCells) {
  const PreparedMesh mesh = prepare_mesh(make_block(4).view());
  for (std::size_t i = 1; i < mesh.boundary.size(); ++i) EXPECT_LE(mesh.boundary[i - 1].cell, mesh.boundary[i].cell);
}

TEST(Prepare, OrderOfPointsAndCellsDoesNotMatterForTetrahedra) {
  // Shuffle the cells and rotate each one's corners, by odd permutations too.
  const PreparedMesh block = prepare_mesh(make_block(5).view());
  TestMesh sorted, shuffled;
  for (std::uint32_t v = 0; v < block.vertices.size(); ++v) {
    sorted.add_point(position(block, v), v);
    shuffled.add_point(position(block, v), v);
  }
  std::vector<Corners> cells = recover_cells(block);
  for (const Corners& c : cells) sorted.add_cell(CellType::kTetrahedron, {c[0], c[1], c[2], c[3]});
  std::mt19937 random(5);
  std::shuffle(cells.begin(), cells.end(), random);
  for (Corners c : cells) {
    std::shuffle(c.begin(), c.end(), random);
    shuffled.add_cell(CellType::kTetrahedron, {c[0], c[1], c[2], c[3]});
  }
  const PreparedMesh a = prepare_mesh(sorted.view()), b = prepare_mesh(shuffled.view());
  EXPECT_TRUE(is_same_bytes(a.cells, b.cells));
  EXPECT_TRUE(is_same_bytes(a.boundary, b.boundary));
  EXPECT_TRUE(is_same_bytes(a.vertices, b.vertices));
}

TEST(Prepare, SameBytesForAnyNumberOfThreads) {
  for (const char* name : {"buckyball", "duct"})
    for (const char* array : {"", "volume"}) {
      const bool is_duct = std::string(name) == "duct";
      if (!is_duct && *array) continue;
      const Dataset dataset = make_embedded(name, is_duct ? 12000 : 60000, array);
      const PreparedMesh one = prepare_with_threads(dataset.mesh, 1);
      for (const int threads : {2, 3, 8}) {
        const PreparedMesh many = prepare_with_threads(dataset.mesh, threads);
        EXPECT_TRUE(is_same_bytes(one.vertices, many.vertices));
        EXPECT_TRUE(is_same_bytes(one.cells, many.cells));
        EXPECT_TRUE(is_same_bytes(one.boundary, many.boundary));
        EXPECT_TRUE(is_same_bytes(one.cell_scalars, many.cell_scalars));
        EXPECT_EQ(one.scalar_scale, many.scalar_scale);
        EXPECT_EQ(one.scalar_offset, many.scalar_offset);
      }
    }
}

TEST(Prepare, NeighboursInSpaceAreNeighboursInMemory) {
  const PreparedMesh mesh = prepare_mesh(make_embedded("buckyball").mesh);
  std::size_t links = 0, far = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const std::uint32_t neighbour : mesh.cells[c].neighbours) {
      if (neighbour == kNoCell) continue;
      ++links;
      far += std::max<std::size_t>(c, neighbour) - std::min<std::size_t>(c, neighbour) > 1600;  // 32 kB of cells
    }
  EXPECT_LT(static_cast<double>(far) / static_cast<double>(links), 0.1);
}

TEST(Prepare, CellDataIsRepeatedForEachTetrahedron) {
  TestMesh mesh = make_block(3);
  mesh.association = Association::kCell;
  mesh.scalars.clear();
  for (int cell = 0; cell < 27; ++cell) mesh.scalars.push_back(100.0 + cell);
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  ASSERT_EQ(prepared.cell_scalars.size(), prepared.cells.size());
  EXPECT_EQ(prepared.association, Association::kCell);
  EXPECT_EQ(prepared.scalar_range.min, 100.0);
  EXPECT_EQ(prepared.scalar_range.max, 126.0);
  const std::vector<Corners> cells = recover_cells(prepared);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    Point middle{};
    for (const std::uint32_t vertex : cells[c])
      for (int axis = 0; axis < 3; ++axis) middle[axis] += 0.25 * position(prepared, vertex)[axis];
    const double expected = 100.0 + std::floor(middle[0]) + 3 * std::floor(middle[1]) + 9 * std::floor(middle[2]);
    EXPECT_NEAR(prepared.scalar_offset + prepared.cell_scalars[c] * prepared.scalar_scale, expected, 1e-4);
  }
}

TEST(Prepare, TellsProgressAndStops) {
  const Dataset dataset = make_embedded("buckyball");
  std::vector<double> told;
  std::atomic<bool> cancelled{false};
  Progress progress;
  progress.cancelled = &cancelled;
  progress.report = [&](std::string_view step, double fraction) {
    EXPECT_EQ(step, "prepare");
    told.push_back(fraction);
  };
  prepare_mesh(dataset.mesh, progress);
  ASSERT_GT(told.size(), 5u);
  EXPECT_EQ(told.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  progress.report = [&](std::string_view, double fraction) { cancelled = fraction > 0.3; };
  try {
    prepare_mesh(dataset.mesh, progress);
    ADD_FAILURE() << "was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace tetravox::test
