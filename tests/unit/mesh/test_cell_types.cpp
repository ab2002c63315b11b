/// Each type of cell: its split fills it, and two cells that share a face split that face alike.

#include "tests/unit/mesh/test_mesh.h"

#include <numbers>
#include <numeric>
#include <random>
#include <string>

namespace tetravox::test {
namespace {

using Ids = std::vector<std::uint32_t>;

/// A cell of one type in a reference position, with its faces' nodes in order around the face (nodes in the middle of
/// a face last).
struct ReferenceCell {
  CellType type;
  std::vector<Point> nodes;
  std::vector<Ids> faces;     ///< all nodes of each face
  std::vector<Ids> outlines;  ///< corners of each face
  double volume;
  std::size_t most_tetrahedra;
};

Point mean(const std::vector<Point>& nodes, const Ids& ids) {
  Point sum{};
  for (const std::uint32_t id : ids)
    for (int axis = 0; axis < 3; ++axis) sum[axis] += nodes[id][axis] / static_cast<double>(ids.size());
  return sum;
}

const std::vector<Point> kTetrahedronCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Ids> kTetrahedronFaces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};
const std::vector<Ids> kTetrahedronEdges = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
const std::vector<Point> kHexahedronCorners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<Ids> kHexahedronFaces = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                           {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
const std::vector<Ids> kHexahedronEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                           {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
const std::vector<Point> kWedgeCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
const std::vector<Ids> kWedgeFaces = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
const std::vector<Ids> kWedgeEdges = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
const std::vector<Point> kPyramidCorners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
const std::vector<Ids> kPyramidFaces = {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
const std::vector<Ids> kPyramidEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};

/// Corners, then a node in the middle of each of `middles`.
ReferenceCell make_reference(CellType type, std::vector<Point> corners, const std::vector<Ids>& faces,
                             const std::vector<Ids>& middles, double volume, std::size_t most) {
  const std::vector<Point> nodes = corners;
  for (const Ids& ids : middles) corners.push_back(mean(nodes, ids));
  ReferenceCell cell{type, corners, faces, faces, volume, most};
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t m = 0; m < middles.size(); ++m) {
      const bool is_on_face = std::all_of(middles[m].begin(), middles[m].end(), [&](std::uint32_t id) {
        return std::find(faces[f].begin(), faces[f].end(), id) != faces[f].end();
      });
      if (is_on_face) cell.faces[f].push_back(static_cast<std::uint32_t>(nodes.size() + m));
    }
  return cell;
}

std::vector<Ids> joined(std::initializer_list<std::vector<Ids>> lists) {
  std::vector<Ids> all;
  for (const std::vector<Ids>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

ReferenceCell make_prism(CellType type, std::uint32_t sides, std::size_t most) {
  std::vector<Point> corners;
  std::vector<Ids> faces(2);
  for (std::uint32_t i = 0; i < 2 * sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    corners.push_back({std::cos(angle), std::sin(angle), i < sides ? 0.0 : 1.0});
    faces[i / sides].push_back(i);
  }
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t next = (i + 1) % sides;
    faces.push_back({i, next, next + sides, i + sides});
  }
  return make_reference(type, corners, faces, {}, 0.5 * sides * std::sin(2.0 * std::numbers::pi / sides), most);
}

ReferenceCell make_voxel() {
  ReferenceCell cell = make_reference(CellType::kVoxel, kHexahedronCorners, kHexahedronFaces, {}, 1.0, 6);
  const Ids order = {0, 1, 3, 2, 4, 5, 7, 6};
  for (std::size_t i = 0; i < 8; ++i) cell.nodes[i] = kHexahedronCorners[order[i]];
  for (Ids& face : cell.faces)
    for (std::uint32_t& node : face) node = order[node];
  cell.outlines = cell.faces;
  return cell;
}

std::vector<ReferenceCell> reference_cells() {
  const std::vector<Ids> hexahedron_sides = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}};
  const std::vector<Ids> wedge_sides = {{0, 1, 3, 4}, {1, 2, 4, 5}, {2, 0, 3, 5}};
  const std::vector<Ids> wedge_ends = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}};
  const std::vector<Ids> hexahedron_middle = {{0, 1, 2, 3, 4, 5, 6, 7}};
  ReferenceCell pyramid37 = make_reference(CellType::kTriquadraticPyramid, kPyramidCorners, kPyramidFaces,
                                           joined({kPyramidEdges, kPyramidFaces}), 1.0 / 3.0, 32);
  pyramid37.nodes.push_back({0.5, 0.5, 0.25});
  return {
      make_reference(CellType::kTetrahedron, kTetrahedronCorners, kTetrahedronFaces, {}, 1.0 / 6.0, 1),
      make_voxel(),
      make_reference(CellType::kHexahedron, kHexahedronCorners, kHexahedronFaces, {}, 1.0, 6),
      make_reference(CellType::kWedge, kWedgeCorners, kWedgeFaces, {}, 0.5, 3),
      make_reference(CellType::kPyramid, kPyramidCorners, kPyramidFaces, {}, 1.0 / 3.0, 2),
      make_prism(CellType::kPentagonalPrism, 5, 9),
      make_prism(CellType::kHexagonalPrism, 6, 12),
      make_reference(CellType::kQuadraticTetrahedron, kTetrahedronCorners, kTetrahedronFaces, kTetrahedronEdges,
                     1.0 / 6.0, 8),
      make_reference(CellType::kQuadraticHexahedron, kHexahedronCorners, kHexahedronFaces, kHexahedronEdges, 1.0, 22),
      make_reference(CellType::kQuadraticWedge, kWedgeCorners, kWedgeFaces, kWedgeEdges, 0.5, 18),
      make_reference(CellType::kQuadraticPyramid, kPyramidCorners, kPyramidFaces, kPyramidEdges, 1.0 / 3.0, 16),
      make_reference(CellType::kTriquadraticHexahedron, kHexahedronCorners, kHexahedronFaces,
                     joined({kHexahedronEdges, kHexahedronFaces, hexahedron_middle}), 1.0, 48),
      make_reference(CellType::kQuadraticLinearWedge, kWedgeCorners, kWedgeFaces, wedge_ends, 0.5, 12),
      make_reference(CellType::kBiquadraticQuadraticWedge, kWedgeCorners, kWedgeFaces,
                     joined({kWedgeEdges, wedge_sides}), 0.5, 24),
      make_reference(CellType::kBiquadraticQuadraticHexahedron, kHexahedronCorners, kHexahedronFaces,
                     joined({kHexahedronEdges, hexahedron_sides}), 1.0, 36),
      pyramid37};
}

double face_area(const ReferenceCell& cell, std::size_t face) {
  const Ids& outline = cell.outlines[face];
  Point normal{};
  for (std::size_t i = 2; i < outline.size(); ++i) {
    const Point a = cell.nodes[outline[0]];
    const Point n = cross(minus(cell.nodes[outline[i - 1]], a), minus(cell.nodes[outline[i]], a));
    for (int axis = 0; axis < 3; ++axis) normal[axis] += n[axis];
  }
  return 0.5 * std::sqrt(dot(normal, normal));
}

double surface_area(const ReferenceCell& cell) {
  double area = 0.0;
  for (std::size_t face = 0; face < cell.faces.size(); ++face) area += face_area(cell, face);
  return area;
}

/// The point mirrored in the plane of a face.
Point mirrored(const ReferenceCell& cell, std::size_t face, const Point& p) {
  const Ids& outline = cell.outlines[face];
  const Point a = cell.nodes[outline[0]];
  const Point n = cross(minus(cell.nodes[outline[1]], a), minus(cell.nodes[outline[2]], a));
  const double t = 2.0 * dot(minus(p, a), n) / dot(n, n);
  return {p[0] - t * n[0], p[1] - t * n[1], p[2] - t * n[2]};
}

/// Writes a cell with given ids, as its own type or as a polyhedron of its outlines.
void add_reference(TestMesh& mesh, const ReferenceCell& cell, const Ids& ids, bool as_polyhedron) {
  if (!as_polyhedron) return mesh.add_cell(cell.type, ids);
  Ids stream = {static_cast<std::uint32_t>(cell.outlines.size())};
  for (const Ids& outline : cell.outlines) {
    stream.push_back(static_cast<std::uint32_t>(outline.size()));
    for (const std::uint32_t node : outline) stream.push_back(ids[node]);
  }
  mesh.add_cell(CellType::kPolyhedron, stream);
}

/// A cell and its mirror image beyond a face, with point ids permuted by `random`. The points of the face are shared,
/// or doubled (each cell has its own), and moved by `noise`. Returns the ids of the face.
Ids add_pair(TestMesh& mesh, const ReferenceCell& cell, std::size_t face, bool as_polyhedron, bool doubled,
             double noise, std::mt19937& random) {
  const std::size_t n = cell.nodes.size();
  std::uniform_real_distribution<double> offset(-noise, noise);
  std::vector<Point> points(2 * n);
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_shared = std::find(cell.faces[face].begin(), cell.faces[face].end(), i) != cell.faces[face].end();
    points[i] = cell.nodes[i];
    points[n + i] = mirrored(cell, face, cell.nodes[i]);
    for (Point* p : {&points[i], &points[n + i]})
      for (double& x : *p) x += offset(random);
    if (is_shared) points[n + i] = points[i];
  }
  Ids order(2 * n);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<Point> permuted(2 * n);
  for (std::size_t i = 0; i < 2 * n; ++i) permuted[order[i]] = points[i];
  for (const Point& p : permuted) mesh.add_point(p);
  Ids first(order.begin(), order.begin() + static_cast<long>(n)),
      second(order.begin() + static_cast<long>(n), order.end());
  if (!doubled)
    for (const std::uint32_t node : cell.faces[face]) second[node] = first[node];
  add_reference(mesh, cell, first, as_polyhedron);
  add_reference(mesh, cell, second, as_polyhedron);
  Ids shared;
  for (const std::uint32_t node : cell.faces[face]) shared.push_back(first[node]);
  return shared;
}

/// Number of boundary faces with all three vertices among the given points.
std::size_t boundary_within(const PreparedMesh& prepared, const TestMesh& mesh, const Ids& points) {
  std::size_t count = 0;
  for (const BoundaryFace& face : prepared.boundary) {
    std::size_t found = 0;
    for (const std::uint32_t vertex : face.vertices) {
      const Point p = position(prepared, vertex);
      found += std::any_of(points.begin(), points.end(), [&](std::uint32_t id) {
        const Point d = minus(p, {mesh.points[3 * id], mesh.points[3 * id + 1], mesh.points[3 * id + 2]});
        return dot(d, d) < 1e-10;
      });
    }
    count += found == 3;
  }
  return count;
}

bool has_polyhedron_form(CellType type) { return static_cast<int>(type) < 20; }

TEST(CellTypes, SplitFillsTheCell) {
  std::mt19937 random(1);
  for (const ReferenceCell& cell : reference_cells())
    for (int trial = 0; trial < 60; ++trial) {
      SCOPED_TRACE(cell_type_name(static_cast<std::uint8_t>(cell.type)));
      const bool as_polyhedron = has_polyhedron_form(cell.type) && trial % 2 == 1;
      Ids order(cell.nodes.size());
      std::iota(order.begin(), order.end(), 0u);
      std::shuffle(order.begin(), order.end(), random);
      TestMesh mesh;
      std::vector<Point> permuted(order.size());
      for (std::size_t i = 0; i < order.size(); ++i) permuted[order[i]] = cell.nodes[i];
      for (const Point& p : permuted) mesh.add_point(p);
      add_reference(mesh, cell, order, as_polyhedron);
      const PreparedMesh prepared = prepare_mesh(mesh.view());
      EXPECT_NEAR(total_volume(prepared), cell.volume, 1e-6);
      EXPECT_NEAR(boundary_area(prepared), surface_area(cell), 1e-5);
      EXPECT_LE(prepared.cells.size(), cell.most_tetrahedra);
      EXPECT_EQ(prepared.report.overlapping_faces, 0u);
      EXPECT_EQ(prepared.report.degenerate, 0u);
      EXPECT_EQ(boundary_euler(prepared), 2);
      expect_closed_boundary(prepared);
    }
}

TEST(CellTypes, NeighboursSplitTheirFaceAlike) {
  std::mt19937 random(2);
  for (const ReferenceCell& cell : reference_cells())
    for (std::size_t face = 0; face < cell.faces.size(); ++face)
      for (int trial = 0; trial < 24; ++trial) {
        SCOPED_TRACE(cell_type_name(static_cast<std::uint8_t>(cell.type)) + ", face " + std::to_string(face));
        TestMesh mesh;
        const bool as_polyhedron = has_polyhedron_form(cell.type) && trial % 3 == 2;
        add_pair(mesh, cell, face, as_polyhedron, trial % 2 == 1, 0.0, random);
        const PreparedMesh prepared = prepare_mesh(mesh.view());
        EXPECT_NEAR(total_volume(prepared), 2.0 * cell.volume, 2e-6);
        EXPECT_NEAR(boundary_area(prepared), 2.0 * (surface_area(cell) - face_area(cell, face)), 1e-4);
        EXPECT_EQ(prepared.report.overlapping_faces, 0u);
        EXPECT_EQ(boundary_euler(prepared), 2);
      }
}

TEST(CellTypes, WarpedNeighboursHaveNoBoundaryBetweenThem) {
  std::mt19937 random(3);
  for (const ReferenceCell& cell : reference_cells())
    for (std::size_t face = 0; face < cell.faces.size(); ++face)
      for (int trial = 0; trial < 12; ++trial) {
        SCOPED_TRACE(cell_type_name(static_cast<std::uint8_t>(cell.type)) + ", face " + std::to_string(face));
        TestMesh mesh;
        const bool as_polyhedron = has_polyhedron_form(cell.type) && trial % 3 == 2;
        const Ids shared = add_pair(mesh, cell, face, as_polyhedron, trial % 2 == 1, 0.02, random);
        const PreparedMesh prepared = prepare_mesh(mesh.view());
        recover_cells(prepared);
        EXPECT_EQ(boundary_within(prepared, mesh, shared), 0u);
        expect_closed_boundary(prepared);
      }
}

TEST(CellTypes, DifferentTypesShareAFace) {
  // A hexahedron with a pyramid on top, a wedge at a side and a tetrahedron on the pyramid.
  std::mt19937 random(4);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Point> points = kHexahedronCorners;
    points.push_back({0.5, 0.5, 1.5});  // 8: the pyramid's top
    points.push_back({2.0, 0.0, 0.5});  // 9, 10: the wedge's edge
    points.push_back({2.0, 1.0, 0.5});
    points.push_back({2.0, 0.5, 2.0});  // 11: the tetrahedron's top
    Ids id(points.size());
    std::iota(id.begin(), id.end(), 0u);
    std::shuffle(id.begin(), id.end(), random);
    std::vector<Point> permuted(points.size());
    for (std::size_t i = 0; i < id.size(); ++i) permuted[id[i]] = points[i];
    TestMesh mesh;
    for (const Point& p : permuted) mesh.add_point(p);
    mesh.add_cell(CellType::kHexahedron, {id[0], id[1], id[2], id[3], id[4], id[5], id[6], id[7]});
    mesh.add_cell(CellType::kPyramid, {id[4], id[5], id[6], id[7], id[8]});
    mesh.add_cell(CellType::kWedge, {id[1], id[5], id[9], id[2], id[6], id[10]});
    mesh.add_cell(CellType::kTetrahedron, {id[5], id[6], id[8], id[11]});
    const PreparedMesh prepared = prepare_mesh(mesh.view());
    EXPECT_NEAR(total_volume(prepared), 1.0 + 1.0 / 6.0 + 0.5 + 1.0 / 6.0, 1e-5);
    EXPECT_EQ(boundary_euler(prepared), 2);
    EXPECT_EQ(prepared.boundary.size(), 8u + 3u + 6u + 3u);  // of each cell in turn
  }
}

TEST(CellTypes, LongerConnectivityMeansCorners) {
  // Some files declare cells of 20 nodes as plain hexahedra.
  const ReferenceCell cell =
      make_reference(CellType::kQuadraticHexahedron, kHexahedronCorners, kHexahedronFaces, kHexahedronEdges, 1.0, 22);
  TestMesh mesh;
  Ids ids;
  for (const Point& p : cell.nodes) ids.push_back(mesh.add_point(p));
  mesh.add_cell(CellType::kHexahedron, ids);
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.cells.size(), 6u);
  EXPECT_EQ(prepared.vertices.size(), 8u);
  EXPECT_NEAR(total_volume(prepared), 1.0, 1e-6);
}

TEST(CellTypes, CollapsedHexahedronBecomesAWedge) {
  TestMesh mesh;
  for (const Point& p : kWedgeCorners) mesh.add_point(p);
  mesh.add_cell(CellType::kHexahedron, {0, 1, 2, 2, 3, 4, 5, 5});
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_NEAR(total_volume(prepared), 0.5, 1e-6);
  EXPECT_EQ(prepared.cells.size(), 3u);
  EXPECT_EQ(prepared.boundary.size(), 8u);
  EXPECT_GT(prepared.report.degenerate, 0u);
}

}  // namespace
}  // namespace tetravox::test
