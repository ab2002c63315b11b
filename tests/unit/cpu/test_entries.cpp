#include "src/cpu/entries.h"

#include "tests/unit/cpu/test_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tetravox::cpu {
namespace {

/// Every ray of every tile.
std::vector<TileRays> collect_all(const PreparedMesh& mesh, const TestFrame& frame, const Kernels& kernels) {
  const TileBins bins = bin_faces(frame.mesh, mesh.boundary.size(), mesh.boundary.size(), frame.camera);
  std::vector<TileRays> tiles;
  TileScratch scratch;
  for (std::size_t tile = 0; tile < bins.tile_count(); ++tile) {
    collect_rays(kernels, frame.mesh, frame.rays.grid, bins, tile, mesh.boundary.size(), frame.camera.is_orthographic,
                 scratch);
    tiles.push_back(scratch.rays);
  }
  return tiles;
}

TEST(Entries, AConvexMeshIsEnteredOnceByEveryRay) {
  // A sphere of flat facets: at most one entry a ray, none missing inside its outline.
  const PreparedMesh mesh = make_test_mesh("sphere");
  const TestFrame frame = make_test_frame(mesh, {{0, -6, 0}, {0, 0, 0}, {0, 0, 1}, 25.0, {}}, 101, 77);
  std::size_t rays = 0;
  std::vector<int> first(77, 1000), last(77, -1), count(77, 0);
  for (const TileRays& tile : collect_all(mesh, frame, kernels_for("")))
    for (const TileRays::Ray& ray : tile.rays) {
      EXPECT_EQ(ray.end - ray.begin, 1u) << ray.column << " " << ray.row;
      first[ray.row] = std::min(first[ray.row], ray.column);
      last[ray.row] = std::max(last[ray.row], ray.column);
      ++count[ray.row];
      ++rays;
    }
  EXPECT_GT(rays, 1000u);
  for (int row = 0; row < 77; ++row)
    if (count[row] > 0) {
      EXPECT_EQ(count[row], last[row] - first[row] + 1) << "a gap in row " << row;
    }
}

TEST(Entries, AreSortedByDepthWhereAMeshHasAHole) {
  const PreparedMesh mesh = make_test_mesh("duct");
  const Camera camera = [&] {
    Camera made;
    for (int i = 0; i < 3; ++i) made.focal_point[i] = 0.5 * (mesh.bounds[i].min + mesh.bounds[i].max);
    made.position = made.focal_point;
    made.position[1] -= 8.0 * mesh.world_per_local;
    made.view_up = {0, 0, 1};
    return made;
  }();
  const TestFrame frame = make_test_frame(mesh, camera, 128, 128);
  std::size_t several = 0;
  for (const TileRays& tile : collect_all(mesh, frame, kernels_for("")))
    for (const TileRays::Ray& ray : tile.rays) {
      several += ray.end - ray.begin > 1;
      for (std::uint32_t i = ray.begin + 1; i < ray.end; ++i)
        EXPECT_LE(tile.entries[i - 1].depth, tile.entries[i].depth);
    }
  EXPECT_GT(several, 0u);
}

TEST(Entries, AreTheSameWithEveryInstructionSet) {
  const PreparedMesh mesh = make_test_mesh("duct?cells=4000");
  const TestFrame frame = make_test_frame(mesh, {{4, -9, 5}, {0, 0, 0}, {0, 0, 1}, 30.0, {}}, 90, 70);
  const auto expected = collect_all(mesh, frame, kernels_for(""));
  for (const std::string& name : available_instruction_sets()) {
    const auto actual = collect_all(mesh, frame, kernels_for(name));
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t tile = 0; tile < actual.size(); ++tile) {
      ASSERT_EQ(actual[tile].entries.size(), expected[tile].entries.size()) << name;
      for (std::size_t i = 0; i < actual[tile].entries.size(); ++i) {
        EXPECT_EQ(actual[tile].entries[i].face, expected[tile].entries[i].face) << name;
        EXPECT_EQ(actual[tile].entries[i].depth, expected[tile].entries[i].depth) << name;
      }
    }
  }
}

}  // namespace
}  // namespace tetravox::cpu
