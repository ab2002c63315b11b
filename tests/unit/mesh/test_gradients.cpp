/// Gradients of cells and of vertices: exact where the field is linear, convergent where it is not, finite always.

#include "src/mesh/gradients.h"

#include "src/mesh/cell_vertices.h"
#include "src/support/threads.h"
#include "tests/unit/mesh/test_mesh.h"

#include <cstring>
#include <functional>

namespace tetravox::test {
namespace {

using mesh::Gradient;

/// n^3 hexahedra in [0, 1]^3 with inner points moved a little, and a field at the points or at the cells' centres.
TestMesh make_field(std::uint32_t n, const std::function<double(const Point&)>& field,
                    Association association = Association::kPoint) {
  TestMesh block = make_block(n);
  for (double& x : block.points) x = x / n + 0.01 / n * std::sin(40.0 * x);
  const auto point = [&](std::size_t i) {
    return Point{block.points[3 * i], block.points[3 * i + 1], block.points[3 * i + 2]};
  };
  block.association = association;
  block.scalars.clear();
  if (association == Association::kPoint) {
    for (std::size_t i = 0; i < block.points.size() / 3; ++i) block.scalars.push_back(field(point(i)));
    return block;
  }
  for (std::size_t cell = 0; cell < block.types.size(); ++cell) {
    Point middle{};
    for (std::size_t k = 0; k < 8; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += point(block.connectivity[8 * cell + k])[axis] / 8.0;
    block.scalars.push_back(field(middle));
  }
  return block;
}

/// Root mean square distance of the vertices' gradients, in the world's units, from `expected`; with `depth` > 0 only
/// of vertices that far from the boundary of the unit cube.
double vertex_error(const PreparedMesh& prepared, const std::function<Point(const Point&)>& expected, double depth) {
  const std::vector<Gradient> gradients = mesh::vertex_gradients(prepared);
  const double scale = mesh::gradient_scale(prepared);
  double sum = 0.0, count = 0.0;
  for (std::uint32_t i = 0; i < gradients.size(); ++i) {
    const Point p = position(prepared, i);
    if (*std::min_element(p.begin(), p.end()) < depth || *std::max_element(p.begin(), p.end()) > 1.0 - depth) continue;
    const Point difference =
        minus({gradients[i][0] * scale, gradients[i][1] * scale, gradients[i][2] * scale}, expected(p));
    sum += dot(difference, difference);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(CellVertices, AreThoseThatRaysFind) {
  const PreparedMesh prepared = prepare_mesh(make_embedded("sphere", 20000).mesh);
  EXPECT_EQ(mesh::find_cell_vertices(prepared), recover_cells(prepared));
}

TEST(Gradients, OfALinearFieldAreExact) {
  const TestMesh field = make_field(5, [](const Point& p) { return 7.0 + 3.0 * p[0] - 2.0 * p[1] + 0.5 * p[2]; });
  const PreparedMesh prepared = prepare_mesh(field.view());
  const double scale = mesh::gradient_scale(prepared);
  const auto expect_all = [&](const std::vector<Gradient>& gradients) {
    for (const Gradient& gradient : gradients) {
      EXPECT_NEAR(gradient[0] * scale, 3.0, 1e-5);
      EXPECT_NEAR(gradient[1] * scale, -2.0, 1e-5);
      EXPECT_NEAR(gradient[2] * scale, 0.5, 1e-5);
      EXPECT_EQ(gradient[3], 0.0f);
    }
  };
  EXPECT_EQ(mesh::cell_gradients(prepared).size(), prepared.cells.size());
  EXPECT_EQ(mesh::vertex_gradients(prepared).size(), prepared.vertices.size());
  expect_all(mesh::cell_gradients(prepared));
  expect_all(mesh::vertex_gradients(prepared));
}

TEST(Gradients, OfAQuadraticFieldConverge) {
  const auto field = [](const Point& p) { return p[0] * p[0] + p[1] * p[2] - 0.5 * p[2] * p[2]; };
  const auto gradient = [](const Point& p) { return Point{2.0 * p[0], p[2], p[1] - p[2]}; };
  const PreparedMesh coarse = prepare_mesh(make_field(6, field).view()),
                     fine = prepare_mesh(make_field(24, field).view());
  EXPECT_LT(vertex_error(coarse, gradient, 0.0), 0.2);
  EXPECT_LT(vertex_error(fine, gradient, 0.0), 0.5 * vertex_error(coarse, gradient, 0.0));
  EXPECT_LT(vertex_error(fine, gradient, 0.1), 0.02);
}

TEST(Gradients, OfCellDataComeFromMeansAtVertices) {
  const auto field = [](const Point& p) { return 3.0 * p[0] - 2.0 * p[1]; };
  const auto gradient = [](const Point&) { return Point{3.0, -2.0, 0.0}; };
  const PreparedMesh prepared = prepare_mesh(make_field(12, field, Association::kCell).view());
  ASSERT_EQ(prepared.association, Association::kCell);
  EXPECT_LT(vertex_error(prepared, gradient, 0.2), 0.1);
  const std::vector<float> scalars = mesh::vertex_scalars(prepared);
  for (std::uint32_t i = 0; i < scalars.size(); ++i) {
    const Point p = position(prepared, i);
    if (*std::min_element(p.begin(), p.end()) < 0.1 || *std::max_element(p.begin(), p.end()) > 0.9) continue;
    EXPECT_NEAR(prepared.scalar_offset + scalars[i] * prepared.scalar_scale, field(p), 0.1);
  }
}

TEST(Gradients, OfThinCellsAreFinite) {
  TestMesh flat;
  add_tetrahedron(flat);
  const std::uint32_t p = flat.add_point({0.25, 0.25, 0.0}, 0.0);
  // Thinner than float can tell, then just not.
  for (const double height : {1e-14, 1e-7}) {
    const std::uint32_t tip = flat.add_point({0.3, 0.3, -height}, 1e3);
    flat.add_cell(CellType::kTetrahedron, {0, 1, p, tip});
  }
  const PreparedMesh prepared = prepare_mesh(flat.view());
  EXPECT_EQ(prepared.cells.size(), 3u);
  for (const auto& gradients : {mesh::cell_gradients(prepared), mesh::vertex_gradients(prepared)})
    for (const Gradient& gradient : gradients)
      for (const float component : gradient) EXPECT_TRUE(std::isfinite(component * component));
}

TEST(Gradients, DoNotDependOnThreads) {
  const PreparedMesh prepared = prepare_mesh(make_embedded("buckyball", 60000).mesh);
  const auto with = [&](int threads) {
    std::vector<Gradient> gradients;
    support::with_threads(threads, [&] { gradients = mesh::vertex_gradients(prepared); });
    return gradients;
  };
  const std::vector<Gradient> one = with(1), four = with(4);
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(Gradient)), 0);
}

}  // namespace
}  // namespace tetravox::test
