#include "src/cpu/face_bins.h"

#include "tests/common/mesh_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tetravox::cpu {
namespace {

/// Thin tetrahedra from corner to corner of a cube: their faces lie in about all squares.
PreparedMesh make_needles(int count) {
  tests::MeshBuilder builder;
  for (int i = 0; i < count; ++i) {
    const double t = 0.4 * i / count, thin = 0.1 / count;
    const std::uint32_t first = builder.add_point({-1.0 + t, -1.0, -1.0}, 0.0);
    builder.add_point({-1.0 + t + thin, -1.0, -1.0}, 0.2);
    builder.add_point({1.0 + t, 1.0, 1.0}, 1.0);
    builder.add_point({1.0 + t, 1.0 + thin, 1.0}, 0.8);
    builder.add_cell(CellType::kTetrahedron, {first, first + 1, first + 2, first + 3});
  }
  return prepare_mesh(builder.build());
}

TEST(FaceBins, LongFacesTakeNoMoreThanTheirShare) {
  const PreparedMesh mesh = make_needles(2000);
  const FaceBins bins(mesh, {0.0, 0.0, -1.0});
  ASSERT_FALSE(bins.is_empty());
  EXPECT_LE(bins.entry_count(), 16 * mesh.boundary.size());
}

TEST(FaceBins, KnowTheFacesOverAPlace) {
  tests::BoxOptions options;
  options.bricks = {3, 3, 3};
  const PreparedMesh mesh = prepare_mesh(tests::make_box(options, [](const Vector3& p) { return p[0]; }));
  const FaceBins bins(mesh, {0.0, 0.0, -1.0});
  // The light enters from above: two triangles for each of nine squares.
  EXPECT_EQ(bins.entry_count() >= 18, true);
  for (const double x : {-0.4, 0.05, 0.3}) {
    const auto faces = bins.faces_at({x, 0.1, 0.0});
    const bool is_known = std::any_of(faces.begin(), faces.end(), [&](std::uint32_t face) {
      double low = 1e30, high = -1e30;
      for (const std::uint32_t id : mesh.boundary[face].vertices) {
        low = std::min<double>(low, mesh.vertices[id].x);
        high = std::max<double>(high, mesh.vertices[id].x);
      }
      return low <= x && x <= high;
    });
    EXPECT_TRUE(is_known) << x;
  }
}

}  // namespace
}  // namespace tetravox::cpu
