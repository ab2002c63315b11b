/// Local coordinates and stored scalars: nothing is lost to float.

#include "tests/unit/mesh/test_mesh.h"

#include <cstring>
#include <string>

namespace tetravox::test {
namespace {

TestMesh transformed(const TestMesh& mesh, double scale, const Point& shift) {
  TestMesh result = mesh;
  for (std::size_t i = 0; i < result.points.size(); ++i) result.points[i] = result.points[i] * scale + shift[i % 3];
  return result;
}

void expect_same_local_mesh(const PreparedMesh& a, const PreparedMesh& b, float tolerance) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  ASSERT_EQ(a.cells.size(), b.cells.size());
  EXPECT_EQ(std::memcmp(a.cells.data(), b.cells.data(), a.cells.size() * sizeof(TetrahedronLinks)), 0);
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    EXPECT_NEAR(a.vertices[i].x, b.vertices[i].x, tolerance);
    EXPECT_NEAR(a.vertices[i].y, b.vertices[i].y, tolerance);
    EXPECT_NEAR(a.vertices[i].z, b.vertices[i].z, tolerance);
    EXPECT_EQ(a.vertices[i].scalar, b.vertices[i].scalar);
  }
}

TEST(Frames, LocalCoordinatesFillTheUnitCube) {
  TestMesh mesh = make_block(4);
  for (std::size_t i = 0; i < mesh.points.size(); i += 3) mesh.points[i] *= 3.0;
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.origin, (std::array<double, 3>{6.0, 2.0, 2.0}));
  EXPECT_EQ(prepared.world_per_local, 6.0);
  float x = 0, y = 0;
  for (const Vertex& v : prepared.vertices) {
    x = std::max(x, std::abs(v.x));
    y = std::max(y, std::abs(v.y));
  }
  EXPECT_EQ(x, 1.0f);
  EXPECT_FLOAT_EQ(y, 1.0f / 3.0f);
}

TEST(Frames, MovedAndScaledMeshesAreTheSameInside) {
  const TestMesh block = make_block(6);
  const PreparedMesh expected = prepare_mesh(block.view());
  for (const double scale : {1e-6, 1e6, 1e-30, 1e30, 1e-150, 1e150, 1e300, 1e-300}) {
    SCOPED_TRACE("scale " + std::to_string(scale));
    expect_same_local_mesh(expected, prepare_mesh(transformed(block, scale, {0, 0, 0}).view()), 1e-6f);
  }
  expect_same_local_mesh(expected, prepare_mesh(transformed(block, 1.0, {1e7, -1e7, 3e7}).view()), 1e-6f);
  expect_same_local_mesh(expected, prepare_mesh(transformed(block, 1e-6, {10, -20, 5}).view()), 1e-4f);
}

TEST(Frames, CoordinatesUpToTheLargestDouble) {
  const TestMesh block = make_block(2);
  TestMesh huge = block;
  for (double& x : huge.points) x = (x - 1.0) * 1.7e308;
  expect_same_local_mesh(prepare_mesh(block.view()), prepare_mesh(huge.view()), 1e-6f);
}

TEST(Frames, NarrowRangesAreStoredAroundTheirMiddle) {
  TestMesh mesh = make_block(4);
  for (double& s : mesh.scalars) s = 101325.0 + 1e-6 * s;
  const PreparedMesh prepared = prepare_mesh(mesh.view());
  const double range = 444e-6;
  EXPECT_NEAR(prepared.scalar_range.max - prepared.scalar_range.min, range, 1e-10);
  EXPECT_NEAR(prepared.scalar_offset, 101325.0 + range / 2, 1e-9);
  float largest = 0;
  for (const Vertex& v : prepared.vertices) largest = std::max(largest, std::abs(v.scalar));
  EXPECT_GE(largest, 0.5f);
  EXPECT_LE(largest, 2.0f);
  EXPECT_EQ(std::exp2(std::round(std::log2(prepared.scalar_scale))), prepared.scalar_scale);
}

TEST(Frames, WideRangesKeepZero) {
  TestMesh mesh = make_block(4);
  for (double& s : mesh.scalars) s *= 1e9;
  PreparedMesh prepared = prepare_mesh(mesh.view());
  EXPECT_EQ(prepared.scalar_offset, 0.0);
  for (double& s : mesh.scalars) s *= 1e-300;
  prepared = prepare_mesh(mesh.view());
  float largest = 0;
  for (const Vertex& v : prepared.vertices) largest = std::max(largest, std::abs(v.scalar));
  EXPECT_GE(largest, 1.0f);
  EXPECT_LE(largest, 2.0f);
}

TEST(Frames, AFillValueDoesNotDestroyTheRest) {
  for (const double fill : {1e30, -1e20, 3.4e38, 1e50}) {
    TestMesh mesh = make_block(4);
    mesh.scalars[62] = fill;
    const PreparedMesh prepared = prepare_mesh(mesh.view());
    std::size_t kept = 0;
    for (const Vertex& v : prepared.vertices) {
      ASSERT_TRUE(std::isfinite(v.scalar));
      const double value = prepared.scalar_offset + v.scalar * prepared.scalar_scale;
      kept += value == 0.0 || std::abs(value - std::round(value)) < 1e-4;
    }
    EXPECT_GE(kept, 124u) << fill;
  }
}

TEST(Frames, ConstantFields) {
  for (const double value : {0.0, 5.0, -1e300, 1e-310}) {
    TestMesh mesh = make_block(2);
    mesh.scalars.assign(27, value);
    const PreparedMesh prepared = prepare_mesh(mesh.view());
    EXPECT_EQ(prepared.scalar_range.min, value);
    EXPECT_EQ(prepared.scalar_range.max, value);
    for (const Vertex& v : prepared.vertices) {
      EXPECT_TRUE(std::isfinite(v.scalar));
      EXPECT_EQ(prepared.scalar_offset + v.scalar * prepared.scalar_scale, value);
    }
  }
}

}  // namespace
}  // namespace tetravox::test
