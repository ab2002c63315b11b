// Cells that hide one another in a circle.

#include "tests/unit/sort/sort_meshes.h"

#include <set>

namespace tetravox::tests {
namespace {

TEST(Cycles, ARingIsFoundAndBroken) {
  const PreparedMesh mesh = prepare_mesh(make_ring());
  ASSERT_EQ(mesh.cells.size(), 3u);
  VisibilitySorter sorter(mesh);
  SortStatistics statistics;
  const Camera camera = look_along_z(mesh, 12.0);
  const auto order = sorter.sort(camera, {}, &statistics);
  EXPECT_EQ(statistics.boundary_relations, 3u);
  EXPECT_EQ(statistics.cycles, 1u);
  EXPECT_EQ(statistics.cyclic_cells, 3u);
  EXPECT_EQ(statistics.broken_relations, 1u);
  const OrderReport report = check(mesh, camera, order, 256);
  EXPECT_TRUE(report.is_permutation);
  EXPECT_GT(report.wrong_segments, 0u);
  EXPECT_EQ(report.intersections, 0u);
}

TEST(Cycles, FromAsideThereIsNone) {
  const PreparedMesh mesh = prepare_mesh(make_ring());
  VisibilitySorter sorter(mesh);
  Camera camera = look_along_z(mesh, 12.0);
  camera.position = {15, 1, 0.2};
  camera.view_up = {0, 0, 1};
  SortStatistics statistics;
  const auto order = sorter.sort(camera, {}, &statistics);
  EXPECT_EQ(statistics.cycles, 0u);
  EXPECT_EQ(check(mesh, camera, order, 256).wrong_segments, 0u);
}

TEST(Cycles, ManyRingsAndWhatIsInNoneStaysRight) {
  // Rings in layers: each one in a circle of its own, all of them in order with a box behind and one in front.
  MeshBuilder builder;
  constexpr int kRings = 300;
  for (int i = 0; i < kRings; ++i)
    add_ring(builder, 3 + i % 5, {8.0 * (i % 10), 8.0 * (i / 10 % 5), 3.0 * (i / 50)}, 1.0);
  BoxOptions box;
  box.bricks = {5, 5, 2};
  box.lower = {-4, -4, -5};
  box.upper = {76, 36, -3};
  add_box(builder, box, any_field);
  const PreparedMesh mesh = prepare_mesh(builder.build());
  VisibilitySorter sorter(mesh);
  Camera camera = look_along_z(mesh, 200.0);
  camera.parallel_scale = 45.0;
  SortStatistics statistics;
  const auto order = sorter.sort(camera, {}, &statistics);
  EXPECT_TRUE(check(mesh, camera, order, 0).is_permutation);
  EXPECT_GE(statistics.cycles, 50u);
  EXPECT_LE(statistics.cycles, static_cast<std::uint64_t>(kRings));
  EXPECT_GT(statistics.broken_relations, 0u);
  // Cells of the box come first: no ring is behind it.
  const std::set<std::uint32_t> first(order.begin(), order.begin() + 50 * 5);
  EXPECT_EQ(check(mesh, camera, order, 0).face_violations, 0u);
  VisibilitySorter again(mesh);
  EXPECT_TRUE(std::ranges::equal(again.sort(camera, {.threads = 1}), order));
}

TEST(Cycles, ASoupOfIntersectingCellsKeepsEveryCell) {
  const PreparedMesh mesh = prepare_mesh(make_soup(400, 7));
  for (const SortMethod method : kAllMethods) {
    VisibilitySorter sorter(mesh);
    for (const NamedCamera& view : make_cameras(mesh.bounds)) {
      SortStatistics statistics;
      const auto order = sorter.sort(view.camera, {.method = method}, &statistics);
      const OrderReport report = check(mesh, view.camera, order, 16);
      EXPECT_TRUE(report.is_permutation) << name_of(method) << ", " << view.name;
      EXPECT_GT(report.intersections, 0u);
    }
  }
}

}  // namespace
}  // namespace tetravox::tests
