// The checker, and the parts that sorting is made of.

#include "src/mesh/cell_vertices.h"
#include "src/sort/cell_interval.h"
#include "src/sort/centroid_order.h"
#include "src/sort/face_sides.h"
#include "src/sort/gap_relations.h"
#include "src/sort/sorted_cells.h"
#include "tests/unit/sort/sort_meshes.h"
#include "tetravox/error.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace tetravox::tests {
namespace {

using sort::operator+, sort::operator-, sort::operator*;

TEST(OrderChecker, TheReverseIsWrongEverywhere) {
  BoxOptions box;
  const PreparedMesh mesh = prepare_mesh(make_box(box, any_field));
  const Camera camera = make_cameras(mesh.bounds)[0].camera;
  VisibilitySorter sorter(mesh);
  const auto front = sorter.sort(camera, {.direction = SortDirection::kFrontToBack});
  const OrderReport wrong = check(mesh, camera, front);
  EXPECT_TRUE(wrong.is_permutation);
  EXPECT_GT(wrong.face_pairs, mesh.cells.size());
  EXPECT_EQ(wrong.face_violations, wrong.face_pairs);
  // All but the first on each ray that meets more than one.
  EXPECT_EQ(wrong.wrong_segments, wrong.segments - wrong.rays);
  const OrderReport right = check_order(mesh, camera, front, {SortDirection::kFrontToBack, 48, 48, 1});
  EXPECT_EQ(right.face_violations + right.wrong_segments, 0u);
  EXPECT_EQ(right.segments, wrong.segments);
}

TEST(OrderChecker, TwoCellsInTheWrongOrder) {
  const PreparedMesh mesh = prepare_mesh(make_loose_tetrahedra(2, 5));
  const Camera camera = make_cameras(mesh.bounds)[0].camera;
  VisibilitySorter sorter(mesh);
  const auto order = sorter.sort(camera);
  std::uint64_t found = 0;
  for (std::size_t i = 0; i + 1 < order.size(); ++i)
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      std::vector<std::uint32_t> swapped(order.begin(), order.end());
      std::swap(swapped[i], swapped[k]);
      found += check(mesh, camera, swapped).wrong_segments > 0;
    }
  EXPECT_GE(found, 5u);
  EXPECT_EQ(check(mesh, camera, order).wrong_segments, 0u);
}

TEST(OrderChecker, FacesAreJudgedByThePlacesOfVertices) {
  MeshBuilder builder;
  const auto point = [&](double x, double y, double z) { return builder.add_point({x, y, z}, z); };
  const std::uint32_t a = point(0, 0, 0), b = point(1, 0, 0), c = point(0, 1, 0);
  builder.add_cell(CellType::kTetrahedron, {a, b, c, point(0.2, 0.2, 1)});
  builder.add_cell(CellType::kTetrahedron, {b, a, c, point(0.2, 0.2, -1)});
  const PreparedMesh mesh = prepare_mesh(builder.build());
  const auto vertices = mesh::find_cell_vertices(mesh);
  const auto height = [&](std::uint32_t cell) {
    float sum = 0.0f;
    for (const std::uint32_t id : vertices[cell]) sum += mesh.vertices[id].z;
    return sum;
  };
  Camera camera = look_along_z(mesh, 4.0);
  for (const double side : {-1.0, 1.0}) {
    camera.position = {0.1, 0.1, 4.0 * side};
    camera.focal_point = {0.1, 0.1, 0.0};
    const std::uint32_t front = side * height(0) > side * height(1) ? 0u : 1u;
    for (const bool is_perspective : {true, false}) {
      camera.parallel_scale.reset();
      if (!is_perspective) camera.parallel_scale = 1.0;
      const OrderReport right = check(mesh, camera, std::vector<std::uint32_t>{1 - front, front});
      const OrderReport wrong = check(mesh, camera, std::vector<std::uint32_t>{front, 1 - front});
      EXPECT_EQ(right.face_pairs, 1u);
      EXPECT_EQ(right.face_violations, 0u);
      EXPECT_EQ(wrong.face_violations, 1u);
    }
  }
}

TEST(OrderChecker, WhatIsNoPermutation) {
  const PreparedMesh mesh = prepare_mesh(make_loose_tetrahedra(2, 5));
  const Camera camera = make_cameras(mesh.bounds)[0].camera;
  std::vector<std::uint32_t> order(mesh.cells.size());
  std::iota(order.begin(), order.end(), 0u);
  EXPECT_TRUE(check(mesh, camera, order).is_permutation);
  order[3] = order[4];
  EXPECT_FALSE(check(mesh, camera, order).is_permutation);
  order[3] = 1000;
  EXPECT_FALSE(check(mesh, camera, order).is_permutation);
  order.pop_back();
  EXPECT_FALSE(check(mesh, camera, order).is_permutation);
  EXPECT_FALSE(check(mesh, camera, {}).is_permutation);
  EXPECT_THROW(check_order(mesh, camera, order, {{}, -1, 5, 0}), Error);
}

TEST(OrderChecker, CellsThatIntersectAreCountedNotCompared) {
  MeshBuilder builder;
  for (const double shift : {0.0, 0.2}) {
    std::vector<std::uint32_t> ids;
    for (const Vector3& p : {Vector3{0, 0, 0}, Vector3{1, 0, 0}, Vector3{0, 1, 0}, Vector3{0, 0, 1}})
      ids.push_back(builder.add_point({p[0] + shift, p[1], p[2]}, shift));
    builder.add_cell(CellType::kTetrahedron, ids);
  }
  const PreparedMesh mesh = prepare_mesh(builder.build());
  Camera camera = look_along_z(mesh, 4.0);
  camera.parallel_scale = 0.7;  // both end at z = 0 on every ray
  for (const std::vector<std::uint32_t>& order : {std::vector<std::uint32_t>{0, 1}, {1, 0}}) {
    const OrderReport report = check(mesh, camera, order, 64);
    EXPECT_GT(report.intersections, 0u);
    EXPECT_EQ(report.wrong_segments, 0u);
  }
}

TEST(SortedCells, VerticesAndOrientation) {
  for (const SortMesh& entry : make_acyclic_meshes()) {
    SCOPED_TRACE(entry.name);
    const auto expected = mesh::find_cell_vertices(entry.mesh);
    const auto cells = sort::find_sorted_cells(entry.mesh);
    const bool is_flat = entry.name.find("flat") != std::string::npos;
    ASSERT_EQ(cells.size(), expected.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      ASSERT_EQ(cells[i].ascending(), expected[i]);
      const auto c = sort::corners_of(entry.mesh, cells[i]);
      const double volume = sort::dot(sort::cross(c[1] - c[0], c[2] - c[0]), c[3] - c[0]);
      if (is_flat) continue;
      ASSERT_GT(volume, 0.0) << i;
    }
  }
}

TEST(FaceSides, BothCellsOfAFaceAgree) {
  for (const SortMesh& entry : make_acyclic_meshes()) {
    const auto cells = sort::find_sorted_cells(entry.mesh);
    for (const NamedCamera& view : make_sort_cameras(entry.mesh)) {
      SCOPED_TRACE(entry.name + ", " + view.name);
      std::vector<sort::CellSides> sides;
      sort::find_cell_sides(entry.mesh, cells, sort::make_view_point(entry.mesh, view.camera), sides);
      for (std::uint32_t cell = 0; cell < cells.size(); ++cell)
        for (std::size_t rank = 0; rank < 4; ++rank) {
          const std::uint32_t neighbour = entry.mesh.cells[cell].neighbours[rank];
          if (neighbour == kNoCell) continue;
          const auto& back = entry.mesh.cells[neighbour].neighbours;
          const auto other =
              sides[neighbour][static_cast<std::size_t>(std::find(back.begin(), back.end(), cell) - back.begin())];
          const sort::Side side = sides[cell][rank];
          ASSERT_EQ(other, side == sort::Side::kFront    ? sort::Side::kBehind
                           : side == sort::Side::kBehind ? sort::Side::kFront
                                                         : sort::Side::kEdgeOn);
        }
    }
  }
}

/// The least and the greatest gap between two cells along rays that meet both.
sort::Interval measure_gaps(const std::array<Vector3, 4>& front, const std::array<Vector3, 4>& behind,
                            const sort::ViewPoint& view, std::mt19937& random) {
  std::exponential_distribution<double> weight;
  sort::Interval gaps{1e300, -1e300};
  for (int i = 0; i < 3000; ++i) {
    // A place in the one behind, and the ray through it.
    double sum = 0.0;
    Vector3 p{};
    for (const Vector3& corner : behind) {
      const double w = weight(random);
      sum += w;
      p = p + corner * w;
    }
    p = p * (1.0 / sum);
    const Vector3 direction = view.is_orthographic ? view.forward : p - view.eye;
    const Vector3 origin = view.is_orthographic ? p : view.eye;
    const double least = view.is_orthographic ? -100.0 : 0.0;
    const sort::Interval a = sort::intersect_cell(front, origin, direction, least, 100.0);
    const sort::Interval b = sort::intersect_cell(behind, origin, direction, least, 100.0);
    if (a.length() <= 0.0 || b.length() <= 0.0) continue;
    gaps = {std::min(gaps.begin, b.begin - a.end), std::max(gaps.end, b.begin - a.end)};
  }
  return gaps;
}

TEST(GapRelations, EveryOneIsTrue) {
  std::mt19937 random(1);
  std::uint64_t measured = 0;
  for (const PreparedMesh& mesh : {prepare_mesh(move_points(make_porous_box(4, 0.4, 3), turn_askew)),
                                   prepare_mesh(make_loose_tetrahedra(4, 2)), prepare_mesh(make_seam())}) {
    const auto cells = sort::find_sorted_cells(mesh);
    for (const NamedCamera& camera : make_sort_cameras(mesh)) {
      SCOPED_TRACE(camera.name);
      const sort::ViewPoint view = sort::make_view_point(mesh, camera.camera);
      std::vector<sort::CellSides> sides;
      sort::find_cell_sides(mesh, cells, view, sides);
      for (const sort::GapRelation& gap : sort::find_gap_relations(mesh, cells, sides, view, 2.0)) {
        const sort::Interval gaps = measure_gaps(sort::corners_of(mesh, cells[gap.front]),
                                                 sort::corners_of(mesh, cells[gap.behind]), view, random);
        if (gaps.begin > gaps.end) continue;  // the overlap is too narrow for chance
        ++measured;
        ASSERT_GE(gaps.begin, -1e-6) << gap.front << " before " << gap.behind;
      }
    }
  }
  EXPECT_GT(measured, 1000u);
}

TEST(GapRelations, CanBeCancelled) {
  const PreparedMesh mesh = prepare_mesh(make_loose_tetrahedra(4, 2));
  const auto cells = sort::find_sorted_cells(mesh);
  const sort::ViewPoint view = sort::make_view_point(mesh, make_cameras(mesh.bounds)[0].camera);
  std::vector<sort::CellSides> sides;
  sort::find_cell_sides(mesh, cells, view, sides);
  const std::atomic<bool> is_cancelled{true};
  try {
    sort::find_gap_relations(mesh, cells, sides, view, 2.0, {{}, &is_cancelled});
    ADD_FAILURE() << "it went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCancelled);
  }
}

TEST(CentroidOrder, AsComparingSays) {
  const PreparedMesh mesh = prepare_builtin("duct", 150000);
  const auto cells = sort::find_sorted_cells(mesh);
  for (const NamedCamera& camera : make_cameras(mesh.bounds)) {
    const sort::ViewPoint view = sort::make_view_point(mesh, camera.camera);
    std::vector<float> keys;
    for (const auto& cell : cells) keys.push_back(static_cast<float>(view.depth_key(sort::centroid_of(mesh, cell))));
    std::vector<std::uint32_t> expected(cells.size());
    std::iota(expected.begin(), expected.end(), 0u);
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return keys[a] > keys[b]; });
    sort::CentroidBuffers buffers;
    std::vector<std::uint32_t> order;
    sort::sort_by_centroids(mesh, cells, view, buffers, order);
    EXPECT_EQ(order, expected) << camera.name;
  }
}

}  // namespace
}  // namespace tetravox::tests
