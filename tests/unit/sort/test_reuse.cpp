// Orders that are used again are as right as new ones.

#include "tests/unit/sort/sort_meshes.h"

#include <algorithm>

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

TEST(Reuse, APathGivesWhatSortingAnewGives) {
  const PreparedMesh mesh = make_mesh();
  for (const SortMethod method : kAllMethods) {
    VisibilitySorter sorter(mesh);
    Camera camera = make_cameras(mesh.bounds)[0].camera;
    int reused = 0;
    for (int step = 0; step < 60; ++step) {
      // Small steps, in which no face turns over, and large ones.
      camera = rotate_camera(camera, step % 10 == 9 ? 7.0 : 1e-9, step % 20 == 19 ? 5.0 : 0.0);
      SortStatistics statistics;
      const auto order = sorter.sort(camera, {.method = method}, &statistics);
      reused += statistics.reuse != OrderReuse::kNone;
      VisibilitySorter fresh(mesh);
      EXPECT_TRUE(std::ranges::equal(fresh.sort(camera, {.method = method}), order)) << name_of(method) << " " << step;
      if (method != SortMethod::kXmpvo) continue;
      const OrderReport report = check(mesh, camera, order, 32);
      EXPECT_EQ(report.wrong_segments + report.face_violations, 0u) << step;
    }
    const bool goes_by_sides = method == SortMethod::kMpvo || method == SortMethod::kXmpvo;
    EXPECT_GE(reused, goes_by_sides ? 40 : 0) << name_of(method);
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
      VisibilitySorter fresh(mesh);
      EXPECT_TRUE(std::ranges::equal(fresh.sort(camera, {.method = method}), order)) << name_of(method);
    }
  EXPECT_GT(sorter.bytes(), 16u * mesh.cells.size());
}

}  // namespace
}  // namespace tetravox::tests
