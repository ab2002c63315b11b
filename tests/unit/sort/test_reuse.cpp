// Orders that are used again are as right as new ones.

#include "tests/unit/sort/sort_meshes.h"

#include <algorithm>
#include <map>

namespace tetravox::tests {
namespace {

PreparedMesh make_mesh() { return prepare_mesh(move_points(make_porous_box(5, 0.6, 11), turn_askew)); }

TEST(Reuse, TurningAndZoomingChangeNothing) {
  const PreparedMesh mesh = make_mesh();
  for (const SortMethod method : kAllMethods)
    for (const bool is_orthographic : {false, true}) {
      Camera camera = make_cameras(mesh.bounds)[is_orthographic ? 1 : 0].camera;
      VisibilitySorter sorter(mesh);
      SortStatistics statistics;
      const auto span = sorter.sort(camera, {.method = method}, &statistics);
      const std::vector<std::uint32_t> order(span.begin(), span.end());
      EXPECT_EQ(statistics.reuse, OrderReuse::kNone);
      if (is_orthographic) {
        camera = zoom_camera(camera, 2.0);
        camera.view_up = {0.3, 0.2, 1.0};
      } else {
        camera.focal_point = {0.4, 0.5, -0.3};
        camera.view_angle = 80.0;
      }
      const auto again = sorter.sort(camera, {.method = method}, &statistics);
      EXPECT_EQ(statistics.reuse, OrderReuse::kSameView);
      EXPECT_TRUE(std::ranges::equal(again, order));
      const OrderReport report = check(mesh, camera, again);
      if (method == SortMethod::kXmpvo) {
        EXPECT_EQ(report.wrong_segments + report.face_violations, 0u);
      }
    }
}

TEST(Reuse, NearViewsAreAnsweredFromTheLastOrder) {
  const PreparedMesh mesh = prepare_builtin("duct", 4000);
  for (const SortMethod method : kAllMethods) {
    VisibilitySorter sorter(mesh);
    Camera camera = make_cameras(mesh.bounds)[0].camera;
    std::map<OrderReuse, int> reused;
    for (int step = 0; step < 120; ++step) {
      // Steps in which no face turns over, in which some do, and in which most do.
      const double angle = step % 3 == 0 ? 1e-9 : 0.3;
      camera = rotate_camera(camera, step % 40 == 39 ? 70.0 : angle, step % 20 == 19 ? 5.0 : 0.1);
      SortStatistics statistics, fresh_statistics;
      const auto order = sorter.sort(camera, {.method = method}, &statistics);
      ++reused[statistics.reuse];
      VisibilitySorter fresh(mesh);
      const auto expected = fresh.sort(camera, {.method = method}, &fresh_statistics);
      EXPECT_EQ(fresh_statistics.sorted_cells, mesh.cells.size());
      EXPECT_EQ(statistics.boundary_relations, fresh_statistics.boundary_relations);
      if (method == SortMethod::kCentroid || method == SortMethod::kMpvonc) {
        EXPECT_TRUE(std::ranges::equal(order, expected)) << name_of(method) << " " << step;
        continue;
      }
      const OrderReport report = check(mesh, camera, order, method == SortMethod::kXmpvo ? 32 : 0);
      EXPECT_TRUE(report.is_permutation);
      EXPECT_EQ(report.wrong_segments + report.face_violations, 0u) << name_of(method) << " " << step;
      if (statistics.reuse == OrderReuse::kRepaired) {
        EXPECT_LE(statistics.sorted_cells, mesh.cells.size() / 2);
      }
    }
    const bool goes_by_sides = method == SortMethod::kMpvo || method == SortMethod::kXmpvo;
    EXPECT_GE(reused[OrderReuse::kRepaired], goes_by_sides ? 40 : 0) << name_of(method);
    EXPECT_GE(reused[OrderReuse::kNone], 1) << name_of(method);
  }
}

TEST(Reuse, NoMotionOfFaces) {
  BoxOptions box;
  const PreparedMesh mesh = prepare_mesh(make_box(box, any_field));
  for (const SortMethod method : {SortMethod::kMpvo, SortMethod::kXmpvo}) {
    Camera camera = make_cameras(mesh.bounds)[0].camera;
    VisibilitySorter sorter(mesh);
    SortStatistics statistics;
    const auto span = sorter.sort(camera, {.method = method}, &statistics);
    const std::vector<std::uint32_t> order(span.begin(), span.end());
    camera.position[0] += 1e-7;
    EXPECT_TRUE(std::ranges::equal(sorter.sort(camera, {.method = method}, &statistics), order));
    EXPECT_EQ(statistics.reuse, OrderReuse::kSameSides);
    EXPECT_EQ(statistics.sorted_cells, 0u);
  }
}

/// What comes between two calls must not spoil the order that the second one begins with.
TEST(Reuse, DirectionsMayTakeTurns) {
  const PreparedMesh mesh = make_mesh();
  VisibilitySorter sorter(mesh);
  Camera camera = make_cameras(mesh.bounds)[0].camera;
  for (int step = 0; step < 30; ++step) {
    camera = rotate_camera(camera, 0.5, 0.0);
    const auto direction = step % 3 == 1 ? SortDirection::kFrontToBack : SortDirection::kBackToFront;
    const auto order = sorter.sort(camera, {.direction = direction});
    const OrderReport report = check_order(mesh, camera, order, {direction, 32, 32, 0});
    EXPECT_TRUE(report.is_permutation);
    EXPECT_EQ(report.wrong_segments + report.face_violations, 0u) << step;
  }
}

TEST(Reuse, AnotherMethodIsNotAnsweredFromTheLast) {
  const PreparedMesh mesh = make_mesh();
  const Camera camera = make_cameras(mesh.bounds)[0].camera;
  VisibilitySorter sorter(mesh);
  for (int round = 0; round < 2; ++round)
    for (const SortMethod method : kAllMethods) {
      SortStatistics statistics;
      const auto order = sorter.sort(camera, {.method = method}, &statistics);
      EXPECT_EQ(statistics.reuse, OrderReuse::kNone);
      EXPECT_EQ(statistics.boundary_relations > 0, method == SortMethod::kXmpvo);
      VisibilitySorter fresh(mesh);
      EXPECT_TRUE(std::ranges::equal(fresh.sort(camera, {.method = method}), order)) << name_of(method);
    }
  EXPECT_GT(sorter.bytes(), 16u * mesh.cells.size());
}

}  // namespace
}  // namespace tetravox::tests
