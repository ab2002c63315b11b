/// Cells with many nodes: quadratic cells with straight edges hold a linear field exactly; prisms are boxes cut open.

#include "tests/analytic/closed_form.h"
#include "tests/common/draw.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace tetravox::analytic {
namespace {

using tests::make_settings;
using tests::MeshBuilder;

double linear_field(const Vector3& p) { return 0.5 + 0.21 * p[0] - 0.13 * p[1] + 0.16 * p[2]; }
const OpticalFunction kFunction{
    {{0.0, 0.1, {0.0, 0.3, 0.9}}, {0.6, 2.3, {1.0, 0.4, 0.1}}, {1.0, 0.5, {0.2, 0.9, 0.4}}}};

/// What a ray through a convex body sees of the linear field.
Rgba show_chord(const Ray& ray, const Chord& chord) {
  if (chord.length() == 0.0) return {};
  const double front = linear_field(ray.at(chord.near)), back = linear_field(ray.at(chord.far));
  return integrate(chord.length(), [&](double u) {
    const OpticalPoint point = eval_optical_function(kFunction, front + u * (back - front));
    return Medium{point.extinction, point.color};
  });
}

/// Groups of corners whose means are the nodes that follow the corners, in VTK's order.
using Nodes = std::vector<std::vector<int>>;

const Nodes kTetrahedronEdges = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
const Nodes kHexahedronEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
const Nodes kHexahedronFaces = {{0, 3, 4, 7}, {1, 2, 5, 6}, {0, 1, 4, 5}, {2, 3, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}};
const Nodes kWedgeEdges = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
const Nodes kWedgeSides = {{0, 1, 3, 4}, {1, 2, 4, 5}, {2, 0, 5, 3}};
const Nodes kPyramidEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};
const Nodes kPyramidFaces = {{0, 1, 2, 3}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 1, 2, 3, 4}};

Nodes join(const Nodes& a, const Nodes& b, const Nodes& c = {}) {
  Nodes all = a;
  all.insert(all.end(), b.begin(), b.end());
  all.insert(all.end(), c.begin(), c.end());
  return all;
}

struct HighOrder {
  CellType type, corners;
  Nodes nodes;
};

void PrintTo(const HighOrder& cell, std::ostream* out) { *out << cell_type_name(static_cast<std::uint8_t>(cell.type)); }

/// The mesh with each cell raised to a higher order; nodes are shared between cells.
MeshData raise_order(const MeshData& mesh, const HighOrder& order) {
  MeshBuilder builder;
  const auto point_at = [&](std::uint32_t i) {
    return Vector3{mesh.points[3 * i], mesh.points[3 * i + 1], mesh.points[3 * i + 2]};
  };
  for (std::uint32_t i = 0; i < mesh.point_count(); ++i) builder.add_point(point_at(i), mesh.scalars[i]);
  std::map<std::vector<std::uint32_t>, std::uint32_t> node_ids;
  for (std::size_t cell = 0; cell < mesh.cell_count(); ++cell) {
    const auto corners =
        mesh.connectivity.subspan(mesh.cell_offsets[cell], mesh.cell_offsets[cell + 1] - mesh.cell_offsets[cell]);
    std::vector<std::uint32_t> ids(corners.begin(), corners.end());
    for (const auto& group : order.nodes) {
      std::vector<std::uint32_t> key;
      for (const int corner : group) key.push_back(corners[corner]);
      std::sort(key.begin(), key.end());
      const auto [entry, is_new] = node_ids.try_emplace(key, builder.point_count());
      if (is_new) {
        Vector3 mean{};
        for (const std::uint32_t id : key)
          for (int k = 0; k < 3; ++k) mean[k] += point_at(id)[k] / static_cast<double>(key.size());
        builder.add_point(mean, linear_field(mean));
      }
      ids.push_back(entry->second);
    }
    builder.add_cell(order.type, ids);
  }
  return builder.build();
}

class HighOrderCells : public ::testing::TestWithParam<HighOrder> {};

TEST_P(HighOrderCells, HoldALinearFieldExactly) {
  tests::BoxOptions options;
  options.bricks = {3, 2, 4};
  options.type = GetParam().corners;
  const PreparedMesh mesh = prepare_mesh(raise_order(tests::make_box(options, linear_field), GetParam()));
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = render(mesh, kFunction, camera, make_settings(Integrator::kPartial, 48, 36));
    EXPECT_TRUE(shows(image, camera,
                      [](const Ray& ray) {
                        return show_chord(ray, intersect_box(ray, {-1, -1, -1}, {1, 1, 1}));
                      },
                      {5e-5, 5e-5}))
        << name;
  }
}

const HighOrder kHighOrders[] = {
    {CellType::kQuadraticTetrahedron, CellType::kTetrahedron, kTetrahedronEdges},
    {CellType::kQuadraticHexahedron, CellType::kHexahedron, kHexahedronEdges},
    {CellType::kQuadraticWedge, CellType::kWedge, kWedgeEdges},
    {CellType::kQuadraticPyramid, CellType::kPyramid, kPyramidEdges},
    {CellType::kTriquadraticHexahedron, CellType::kHexahedron,
     join(kHexahedronEdges, kHexahedronFaces, {{0, 1, 2, 3, 4, 5, 6, 7}})},
    {CellType::kQuadraticLinearWedge, CellType::kWedge, {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}}},
    {CellType::kBiquadraticQuadraticWedge, CellType::kWedge, join(kWedgeEdges, kWedgeSides)},
    {CellType::kBiquadraticQuadraticHexahedron, CellType::kHexahedron,
     join(kHexahedronEdges, {kHexahedronFaces.begin(), kHexahedronFaces.begin() + 4})},
    {CellType::kTriquadraticPyramid, CellType::kPyramid, join(kPyramidEdges, kPyramidFaces)}};

INSTANTIATE_TEST_SUITE_P(Types, HighOrderCells, ::testing::ValuesIn(kHighOrders),
                         [](const auto& test) { return "type_" + std::to_string(static_cast<int>(test.param.type)); });

/// A prism over a regular polygon of n corners on the unit circle, z in [-1, 1], as one cell.
MeshData make_prism(int n) {
  MeshBuilder builder;
  std::vector<std::uint32_t> ids;
  for (const double z : {-1.0, 1.0}) {
    for (int i = 0; i < n; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / n;
      const Vector3 p{std::cos(angle), std::sin(angle), z};
      ids.push_back(builder.add_point(p, linear_field(p)));
    }
  }
  const CellType types[] = {CellType::kWedge, CellType::kHexahedron, CellType::kPentagonalPrism,
                            CellType::kHexagonalPrism};
  if (n <= 6) {
    builder.add_cell(types[n - 3], ids);
    return builder.build();
  }
  std::vector<std::uint32_t> stream{static_cast<std::uint32_t>(n + 2)};
  for (const std::uint32_t first : {0, n}) {
    stream.push_back(static_cast<std::uint32_t>(n));
    for (int i = 0; i < n; ++i) stream.push_back(first + static_cast<std::uint32_t>(i));
  }
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<std::uint32_t>(i), b = static_cast<std::uint32_t>((i + 1) % n);
    const auto up = static_cast<std::uint32_t>(n);
    stream.insert(stream.end(), {4, a, b, b + up, a + up});
  }
  builder.add_cell(CellType::kPolyhedron, stream);
  return builder.build();
}

Chord intersect_prism(const Ray& ray, int n) {
  const double infinity = std::numeric_limits<double>::infinity();
  Chord chord = intersect_box(ray, {-infinity, -infinity, -1}, {infinity, infinity, 1});
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.5) / n;
    const double x = std::cos(angle), y = std::sin(angle);
    const double slope = ray.direction[0] * x + ray.direction[1] * y;
    const double t = (std::cos(std::numbers::pi / n) - ray.origin[0] * x - ray.origin[1] * y) / slope;
    if (slope > 0.0) {
      chord.far = std::min(chord.far, t);
    } else {
      chord.near = std::max(chord.near, t);
    }
  }
  return chord;
}

class Prisms : public ::testing::TestWithParam<int> {};

TEST_P(Prisms, HoldALinearField) {
  const PreparedMesh mesh = prepare_mesh(make_prism(GetParam()));
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = render(mesh, kFunction, camera, make_settings(Integrator::kPartial, 48, 36));
    EXPECT_TRUE(shows(image, camera, [](const Ray& ray) { return show_chord(ray, intersect_prism(ray, GetParam())); },
                      {5e-5, 5e-5}))
        << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Corners, Prisms, ::testing::Values(3, 4, 5, 6, 7, 12));

}  // namespace
}  // namespace tetravox::analytic
