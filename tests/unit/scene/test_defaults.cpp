#include "tests/unit/optics/expect_error.h"
#include "tetravox/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace tetravox {
namespace {

using testing::expect_error;
using Ids = std::array<std::uint32_t, 4>;

/// A mesh from explicit tetrahedra, linked by comparing faces.
PreparedMesh make_mesh(const std::vector<Vertex>& vertices, const std::vector<Ids>& tetrahedra) {
  PreparedMesh mesh;
  mesh.vertices = vertices;
  std::map<std::array<std::uint32_t, 3>, std::vector<std::pair<std::uint32_t, int>>> faces;
  for (std::uint32_t cell = 0; cell < tetrahedra.size(); ++cell) {
    Ids ids = tetrahedra[cell];
    std::sort(ids.begin(), ids.end());
    mesh.cells.push_back({ids[0] ^ ids[1] ^ ids[2] ^ ids[3], {kNoCell, kNoCell, kNoCell, kNoCell}});
    for (int r = 0; r < 4; ++r) {
      std::array<std::uint32_t, 3> face{};
      for (int i = 0, k = 0; i < 4; ++i)
        if (i != r) face[static_cast<std::size_t>(k++)] = ids[static_cast<std::size_t>(i)];
      faces[face].push_back({cell, r});
    }
  }
  for (const auto& [face, sides] : faces) {
    if (sides.size() == 1) mesh.boundary.push_back({sides[0].first, face});
    if (sides.size() != 2) continue;
    mesh.cells[sides[0].first].neighbours[static_cast<std::size_t>(sides[0].second)] = sides[1].first;
    mesh.cells[sides[1].first].neighbours[static_cast<std::size_t>(sides[1].second)] = sides[0].first;
  }
  mesh.bounds = {{{-1, 1}, {-1, 1}, {-1, 1}}};
  const auto [min, max] = std::minmax_element(vertices.begin(), vertices.end(),
                                              [](const Vertex& a, const Vertex& b) { return a.scalar < b.scalar; });
  mesh.scalar_range = {min->scalar, max->scalar};
  return mesh;
}

/// n^3 cubes of six tetrahedra in [-1, 1]^3, with scalars by `scalar`.
template <class Scalar>
PreparedMesh make_cube(std::uint32_t n, const Scalar& scalar) {
  std::vector<Vertex> vertices;
  const auto coordinate = [&](std::uint32_t i) { return 2.0f * static_cast<float>(i) / static_cast<float>(n) - 1.0f; };
  for (std::uint32_t k = 0; k <= n; ++k)
    for (std::uint32_t j = 0; j <= n; ++j)
      for (std::uint32_t i = 0; i <= n; ++i) {
        const float x = coordinate(i), y = coordinate(j), z = coordinate(k);
        vertices.push_back({x, y, z, scalar(x, y, z)});
      }
  const auto id = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return (k * (n + 1) + j) * (n + 1) + i; };
  std::vector<Ids> tetrahedra;
  constexpr int kPaths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (std::uint32_t k = 0; k < n; ++k)
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i)
        for (const auto& path : kPaths) {
          std::array<std::uint32_t, 3> p{i, j, k};
          Ids ids{id(p[0], p[1], p[2])};
          for (std::size_t step = 0; step < 3; ++step) {
            ++p[static_cast<std::size_t>(path[step])];
            ids[step + 1] = id(p[0], p[1], p[2]);
          }
          tetrahedra.push_back(ids);
        }
  return make_mesh(vertices, tetrahedra);
}

double total(const Histogram& histogram) {
  return std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0.0);
}

TEST(Histogram, OfALinearFieldIsFlatAndHoldsTheVolume) {
  PreparedMesh mesh = make_cube(8, [](float, float, float z) { return z; });
  mesh.scalar_offset = 10.0;
  mesh.scalar_scale = 4.0;
  mesh.scalar_range = {6.0, 14.0};
  const Histogram histogram = make_histogram(mesh, 8);
  EXPECT_NEAR(histogram.range.min, 6.0, 1e-6);
  EXPECT_NEAR(histogram.range.max, 14.0, 1e-6);
  EXPECT_NEAR(total(histogram), 8.0, 1e-5);
  for (const double count : histogram.counts) EXPECT_NEAR(count, 1.0, 0.02);
}

TEST(Histogram, WeighsByVolumeAndNotByCells) {
  // Half of the space in one layer of cells, the other half in many.
  PreparedMesh mesh = make_cube(8, [](float, float, float z) { return z; });
  for (Vertex& vertex : mesh.vertices) vertex.z = vertex.z < 0.99f ? vertex.z / 7.0f * 4.0f - 0.43f : 1.0f;
  const Histogram histogram = make_histogram(mesh, 8);
  const double last = histogram.counts.back() / total(histogram);
  EXPECT_NEAR(last, (1.0 - (0.75 / 7 * 4 - 0.43)) / (1.0 + 0.43 + 4.0 / 7), 0.01);
}

TEST(Histogram, OfCellDataCountsCellsValues) {
  PreparedMesh mesh = make_cube(4, [](float, float, float) { return 0.0f; });
  mesh.association = Association::kCell;
  mesh.scalar_range = {0, 1};
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) mesh.cell_scalars.push_back(i % 4 == 0 ? 1.0f : 0.0f);
  const Histogram histogram = make_histogram(mesh, 16);
  EXPECT_NEAR(histogram.counts.front(), 6.0, 1e-5);
  EXPECT_NEAR(histogram.counts.back(), 2.0, 1e-5);
  EXPECT_NEAR(total(histogram), 8.0, 1e-5);
}

TEST(Histogram, CutsOutliersOff) {
  PreparedMesh mesh = make_cube(24, [](float x, float, float) { return x; });
  mesh.vertices[mesh.vertices.size() / 2].scalar = 1e9f;
  mesh.scalar_range = {-1, 1e9};
  const Histogram histogram = make_histogram(mesh, 64);
  EXPECT_NEAR(histogram.range.min, -1.0, 1.0);
  EXPECT_NEAR(histogram.range.max, 1.0, 1.0);
  EXPECT_NEAR(total(histogram), 8.0, 1e-4);
}

TEST(Histogram, OfAConstantFieldHasNoWidth) {
  PreparedMesh mesh = make_cube(2, [](float, float, float) { return 0.0f; });
  mesh.scalar_range = {7, 7};
  const Histogram histogram = make_histogram(mesh, 16);
  EXPECT_EQ(histogram.range.min, 7.0);
  EXPECT_EQ(histogram.range.max, 7.0);
  EXPECT_NEAR(total(histogram), 8.0, 1e-5);
}

TEST(Histogram, IsTheSameOnEveryRun) {
  const PreparedMesh mesh = make_cube(20, [](float x, float y, float z) { return std::sin(9 * x) * y + z; });
  const Histogram first = make_histogram(mesh, 256);
  for (int run = 0; run < 5; ++run) EXPECT_EQ(make_histogram(mesh, 256).counts, first.counts);
}

TEST(Histogram, RefusesOddNumbersOfBins) {
  const PreparedMesh mesh = make_cube(1, [](float x, float, float) { return x; });
  for (const int bins : {0, -1, 2'000'000})
    expect_error(
        ErrorCode::kInvalidArgument, [&] { make_histogram(mesh, bins); }, "bins");
}

TEST(CompleteScene, FillsInWhatIsOpenAndKeepsTheRest) {
  const PreparedMesh mesh = make_cube(4, [](float x, float, float) { return x; });
  Scene scene;
  const CompletedScene open = complete_scene(scene, mesh);
  EXPECT_NO_THROW(validate_camera(open.camera));
  EXPECT_FALSE(open.optical_function.points.empty());

  scene.transfer_function = TransferFunction{{{0.0, {1, 0, 0}, 0.5}}, Absorption::kOpacity, std::nullopt};
  scene.camera = Camera{};
  const CompletedScene given = complete_scene(scene, mesh);
  EXPECT_EQ(given.camera.position, Camera{}.position);
  // The unit distance is a hundredth of the diagonal.
  EXPECT_NEAR(given.optical_function.points[0].extinction, std::log(2.0) / (2.0 * std::sqrt(3.0) / 100.0), 1e-9);
}

}  // namespace
}  // namespace tetravox
