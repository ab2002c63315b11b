// All methods on all meshes from all sides.

#include "tests/unit/sort/sort_meshes.h"
#include "tetravox/error.h"

#include <algorithm>

namespace tetravox::tests {
namespace {

const std::vector<SortMesh>& acyclic_meshes() {
  static const std::vector<SortMesh> meshes = make_acyclic_meshes();
  return meshes;
}

/// Calls `body(mesh, camera, order, statistics)` for every mesh and camera.
template <class Body>
void for_each_view(SortMethod method, const Body& body) {
  for (const SortMesh& entry : acyclic_meshes()) {
    VisibilitySorter sorter(entry.mesh);
    for (const NamedCamera& view : make_sort_cameras(entry.mesh)) {
      SCOPED_TRACE(entry.name + ", " + view.name);
      SortStatistics statistics;
      const auto order = sorter.sort(view.camera, {.method = method}, &statistics);
      body(entry, view.camera, order, statistics);
    }
  }
}

TEST(SortMethods, XmpvoIsExactWithoutCycles) {
  std::uint64_t relations = 0;
  for_each_view(SortMethod::kXmpvo,
                [&](const SortMesh& entry, const Camera& camera, auto order, const auto& statistics) {
                  const OrderReport report = check(entry.mesh, camera, order);
                  EXPECT_TRUE(report.is_permutation);
                  EXPECT_EQ(report.face_violations, 0u);
                  EXPECT_EQ(report.wrong_segments, 0u);
                  // Rounding to float pushes points of one side of the turned seam a little through the other.
                  EXPECT_LE(report.intersections, entry.name == "turned seam" ? 2u : 0u);
                  EXPECT_GT(report.segments, 0u);
                  EXPECT_EQ(statistics.cycles, 0u);
                  EXPECT_EQ(statistics.broken_relations, 0u);
                  relations += statistics.boundary_relations;
                });
  EXPECT_GT(relations, 1000u);
}

TEST(SortMethods, MpvoAndMpvoncKeepAllFacesAndAreExactForConvexMeshes) {
  for (const SortMethod method : {SortMethod::kMpvo, SortMethod::kMpvonc})
    for_each_view(method, [](const SortMesh& entry, const Camera& camera, auto order, const auto& statistics) {
      const OrderReport report = check(entry.mesh, camera, order, entry.is_convex ? 48 : 0);
      EXPECT_TRUE(report.is_permutation);
      EXPECT_EQ(report.face_violations, 0u);
      EXPECT_EQ(report.wrong_segments, 0u);
      EXPECT_EQ(statistics.cycles, 0u);
    });
}

TEST(SortMethods, HeuristicsErrWhereTheyAreKnownTo) {
  std::uint64_t mpvo = 0, mpvonc = 0, centroid = 0;
  const auto count = [](SortMethod method, std::uint64_t& wrong) {
    for_each_view(method, [&](const SortMesh& entry, const Camera& camera, auto order, const auto&) {
      wrong += check(entry.mesh, camera, order, 24).wrong_segments;
    });
  };
  count(SortMethod::kMpvo, mpvo);
  count(SortMethod::kMpvonc, mpvonc);
  count(SortMethod::kCentroid, centroid);
  EXPECT_GT(mpvonc, 0u);
  EXPECT_GT(mpvo, mpvonc);
  EXPECT_GT(centroid, mpvonc);
}

TEST(SortMethods, CentroidsComeByDistance) {
  for_each_view(SortMethod::kCentroid,
                [](const SortMesh& entry, const Camera& camera, auto order, const auto& statistics) {
                  EXPECT_TRUE(check(entry.mesh, camera, order, 0).is_permutation);
                  EXPECT_EQ(statistics.cells, entry.mesh.cells.size());
                  EXPECT_EQ(statistics.cycles, 0u);
                });
}

TEST(SortMethods, FrontToBackIsTheReverse) {
  const SortMesh& entry = acyclic_meshes().back();
  const Camera camera = make_cameras(entry.mesh.bounds)[0].camera;
  for (const SortMethod method : kAllMethods) {
    VisibilitySorter sorter(entry.mesh);
    const auto back = sorter.sort(camera, {.method = method});
    const std::vector<std::uint32_t> expected(back.rbegin(), back.rend());
    SortStatistics statistics;
    const auto front = sorter.sort(camera, {.method = method, .direction = SortDirection::kFrontToBack}, &statistics);
    EXPECT_TRUE(std::ranges::equal(front, expected)) << name_of(method);
    EXPECT_EQ(statistics.reuse, OrderReuse::kSameView);
    VisibilitySorter other(entry.mesh);
    EXPECT_TRUE(
        std::ranges::equal(other.sort(camera, {.method = method, .direction = SortDirection::kFrontToBack}), expected))
        << name_of(method);
  }
}

TEST(SortMethods, AnyNumberOfThreadsGivesTheSameOrder) {
  for (const SortMesh& entry : acyclic_meshes())
    for (const NamedCamera& view : make_cameras(entry.mesh.bounds))
      for (const SortMethod method : kAllMethods) {
        VisibilitySorter one(entry.mesh), many(entry.mesh);
        const auto expected = one.sort(view.camera, {.method = method, .threads = 1});
        for (const int threads : {2, 4})
          EXPECT_TRUE(std::ranges::equal(
              many.sort(view.camera, {.method = method, .use_last_order = false, .threads = threads}), expected))
              << entry.name << ", " << view.name << ", " << name_of(method) << ", " << threads;
      }
}

TEST(SortMethods, Names) {
  ASSERT_EQ(sort_method_names().size(), std::size(kAllMethods));
  for (const SortMethod method : kAllMethods) EXPECT_EQ(sort_method_from_name(name_of(method)), method);
  EXPECT_EQ(name_of(SortMethod::kXmpvo), "xmpvo");
  try {
    sort_method_from_name("quick");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_NE(std::string(error.what()).find("centroid, mpvo, mpvonc, xmpvo"), std::string::npos) << error.what();
  }
}

TEST(SortMethods, ACameraWithoutAViewIsRefused) {
  const SortMesh& entry = acyclic_meshes().front();
  Camera camera;
  camera.position = camera.focal_point;
  VisibilitySorter sorter(entry.mesh);
  EXPECT_THROW(sorter.sort(camera), Error);
  EXPECT_THROW(check_order(entry.mesh, camera, {}), Error);
}

TEST(SortMethods, ACancelledSortIsMadeAnew) {
  const PreparedMesh mesh = prepare_mesh(make_loose_tetrahedra(4, 2));
  for (const SortMethod method : {SortMethod::kMpvo, SortMethod::kMpvonc, SortMethod::kXmpvo}) {
    SCOPED_TRACE(name_of(method));
    VisibilitySorter sorter(mesh), fresh(mesh);
    std::atomic<bool> is_cancelled{false};
    const Progress progress{{}, &is_cancelled};
    for (const NamedCamera& view : make_sort_cameras(mesh)) {
      is_cancelled = true;
      EXPECT_THROW(sorter.sort(view.camera, {.method = method}, nullptr, progress), Error);
      is_cancelled = false;
      EXPECT_TRUE(std::ranges::equal(sorter.sort(view.camera, {.method = method}, nullptr, progress),
                                     fresh.sort(view.camera, {.method = method, .use_last_order = false})));
    }
  }
}

}  // namespace
}  // namespace tetravox::tests
