/// Damaged meshes and awkward views: finite pixels, no hang, never blank, and right wherever "right" has a meaning.

#include "tests/analytic/closed_form.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/scenes.h"
#include "tests/reference/integrator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace tetravox::conformance {
namespace {

using analytic::Ray;
using tests::BoxOptions;
using tests::make_box;
using tests::make_settings;
using tests::MeshBuilder;

const Vector3 kLower{-1, -1, -1};
const Vector3 kUpper{1, 1, 1};
const Color kColor{0.9, 0.6, 0.3};
const OpticalFunction kHomogeneous{{{0.0, 0.8, kColor}}};
const OpticalFunction kVaried{{{-2.0, 0.1, {0.1, 0.2, 0.9}},
                               {-0.3, 1.5, {0.2, 0.9, 0.5}},
                               {0.2, 0.2, {0.9, 0.8, 0.2}},
                               {2.0, 3.0, {1, 0.2, 0.1}}}};

double one(const Vector3&) { return 1.0; }
double wavy(const Vector3& p) { return std::sin(3.0 * p[0] + 1.0) * std::cos(2.0 * p[1]) + 0.6 * p[2]; }

/// A list of cells that can be edited before it becomes a mesh.
struct CellList {
  std::vector<Vector3> points;
  std::vector<double> scalars;
  std::vector<std::vector<std::uint32_t>> cells;
  CellType type = CellType::kTetrahedron;

  MeshData build() const {
    MeshBuilder builder;
    for (std::size_t i = 0; i < points.size(); ++i) builder.add_point(points[i], scalars[i]);
    for (const auto& cell : cells) builder.add_cell(type, cell);
    return builder.build();
  }
};

CellList list_cells(const MeshData& mesh) {
  CellList list;
  list.type = mesh.cell_types[0];
  for (std::size_t i = 0; i < mesh.point_count(); ++i) {
    list.points.push_back({mesh.points[3 * i], mesh.points[3 * i + 1], mesh.points[3 * i + 2]});
    list.scalars.push_back(mesh.scalars[i]);
  }
  for (std::size_t cell = 0; cell < mesh.cell_count(); ++cell) {
    const auto begin = mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(mesh.cell_offsets[cell]);
    const auto end = mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(mesh.cell_offsets[cell + 1]);
    list.cells.emplace_back(begin, end);
  }
  return list;
}

CellList list_box(CellType type, const tests::Field& field) {
  BoxOptions options;
  options.type = type;
  return list_cells(make_box(options, field));
}

/// Draws with every integrator from every standard view and holds each picture against the same mesh undamaged, to the
/// bounds that hold for any mesh.
void expect_like(const MeshData& damaged, const MeshData& sound) {
  const PreparedMesh mesh = prepare_mesh(damaged);
  const reference::Tetrahedra tetrahedra = reference::make_tetrahedra(sound);
  for (const auto& [name, camera] : analytic::standard_cameras()) {
    const Image expected = reference::draw(tetrahedra, kVaried, {camera, 72, 54});
    for (const Integrator integrator : tests::kExactIntegrators) {
      const Image image = render(mesh, kVaried, camera, make_settings(integrator, 72, 54));
      EXPECT_TRUE(agrees(image, expected, integrator)) << name << " " << name_of(integrator);
    }
  }
}

/// Draws with every integrator from every standard view; pictures must be valid and show something.
void expect_sane(const MeshData& damaged, std::size_t covered = 300) {
  const PreparedMesh mesh = prepare_mesh(damaged);
  for (const auto& [name, camera] : analytic::standard_cameras()) {
    for (const Integrator integrator : tests::kAllIntegrators) {
      for (const std::string& instruction_set : instruction_sets()) {
        RenderSettings settings = make_settings(integrator, 72, 54);
        settings.instruction_set = instruction_set;
        const Image image = render(mesh, kVaried, camera, settings);
        EXPECT_TRUE(tests::is_valid_picture(image)) << name << " " << name_of(integrator) << " " << instruction_set;
        EXPECT_GE(tests::count_covered(image), covered) << name << " " << name_of(integrator);
      }
    }
  }
}

TEST(Damaged, InvertedCellsAreTurned) {
  CellList list = list_box(CellType::kTetrahedron, wavy);
  const MeshData sound = list.build();
  for (auto& cell : list.cells) std::swap(cell[0], cell[1]);
  expect_like(list.build(), sound);
  for (std::size_t i = 0; i < list.cells.size(); i += 3) std::swap(list.cells[i][2], list.cells[i][3]);
  expect_like(list.build(), sound);
}

TEST(Damaged, InvertedHexahedraAreTurned) {
  CellList list = list_box(CellType::kHexahedron, wavy);
  const MeshData sound = list.build();
  for (std::size_t i = 0; i < list.cells.size(); i += 2)
    for (int k = 0; k < 4; ++k) std::swap(list.cells[i][k], list.cells[i][k + 4]);
  expect_like(list.build(), sound);
}

TEST(Damaged, DuplicatedCellsCountOnce) {
  CellList list = list_box(CellType::kTetrahedron, wavy);
  const MeshData sound = list.build();
  const auto once = list.cells;
  for (std::size_t i = 0; i < once.size(); ++i) {
    list.cells.push_back(once[i]);
    if (i % 5 == 0) list.cells.push_back({once[i][1], once[i][0], once[i][2], once[i][3]});
  }
  EXPECT_EQ(prepare_mesh(list.build()).report.duplicated, once.size() + (once.size() + 4) / 5);
  expect_like(list.build(), sound);
}

TEST(Damaged, FlatCellsAreInvisible) {
  CellList list = list_box(CellType::kTetrahedron, wavy);
  const MeshData sound = list.build();
  std::mt19937 random(3);
  const auto count = static_cast<std::uint32_t>(list.points.size());
  for (int i = 0; i < 60; ++i) {
    // Points of the grid in one plane x = const, or the same point twice.
    const std::uint32_t a = static_cast<std::uint32_t>(random()) % count;
    list.cells.push_back({a, a, (a + 7) % count, (a + 31) % count});
    list.cells.push_back({(a % 20) * 5, (a % 20) * 5 + 5, (a % 20) * 5 + 10, (a % 20) * 5 + 15});
  }
  EXPECT_EQ(prepare_mesh(list.build()).report.degenerate, 120u);
  expect_like(list.build(), sound);
}

TEST(Damaged, AFlatCellBetweenFacesThatDoNotMatchLeavesNoGap) {
  // Two bricks whose common quadrilateral is split along different diagonals, with a flat cell in between.
  CellList list;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        list.points.push_back({x, y, z});
        list.scalars.push_back(wavy({x, y, z}));
      }
  // Quadrilateral in the middle: 4 (--), 5 (-+), 7 (++), 6 (+-); left split along 4-7, right along 5-6.
  const auto cone = [&](std::uint32_t tip, std::vector<std::array<std::uint32_t, 4>> quads) {
    for (const auto& q : quads) {
      list.cells.push_back({tip, q[0], q[1], q[2]});
      list.cells.push_back({tip, q[0], q[2], q[3]});
    }
  };
  cone(0, {{4, 5, 7, 6}, {1, 3, 7, 5}, {2, 3, 7, 6}});
  cone(11, {{5, 7, 6, 4}, {8, 10, 6, 4}, {8, 9, 5, 4}});
  const MeshData sound = list.build();
  list.cells.push_back({4, 5, 7, 6});
  expect_like(sound, sound);
  expect_like(list.build(), sound);
}

TEST(Damaged, SeamsOfDoubledPointsAreClosed) {
  MeshBuilder equal, unequal;
  for (int part = 0; part < 4; ++part) {
    BoxOptions options;
    options.bricks = {2, 3, 4};
    options.lower = {-1.0 + 0.5 * part, -1, -1};
    options.upper = {-0.5 + 0.5 * part, 1, 1};
    tests::add_box(equal, options, wavy);
    tests::add_box(unequal, options, [part](const Vector3& p) { return wavy(p) + 0.3 * part; });
  }
  EXPECT_EQ(prepare_mesh(equal.build()).report.merged_points, 3u * 20u);
  expect_like(equal.build(), equal.build());
  expect_like(unequal.build(), unequal.build());
}

TEST(Damaged, HexahedraCollapsedToWedgesAndPyramids) {
  // Around an axis the inner edge of each hexahedron is one line: its quadrilateral there has no area.
  MeshBuilder builder;
  const int segments = 12, layers = 3;
  for (int layer = 0; layer <= layers; ++layer) {
    const double z = -1.0 + 2.0 * layer / layers;
    builder.add_point({0, 0, z}, wavy({0, 0, z}));
    for (int i = 0; i < segments; ++i) {
      const Vector3 p{std::cos(i * 0.52359877559829887), std::sin(i * 0.52359877559829887), z};
      builder.add_point(p, wavy(p));
    }
  }
  const auto id = [&](int layer, int i) {
    return static_cast<std::uint32_t>(layer * (segments + 1) + 1 + i % segments);
  };
  for (int layer = 0; layer < layers; ++layer) {
    const auto low = static_cast<std::uint32_t>(layer * (segments + 1));
    const auto high = static_cast<std::uint32_t>((layer + 1) * (segments + 1));
    for (int i = 0; i < segments; ++i)
      builder.add_cell(CellType::kHexahedron,
                       {low, id(layer, i), id(layer, i + 1), low, high, id(layer + 1, i), id(layer + 1, i + 1), high});
  }
  expect_like(builder.build(), builder.build());
}

TEST(Damaged, ThreeCellsOnAFace) {
  CellList list = list_box(CellType::kTetrahedron, wavy);
  for (std::size_t i = 0; i < 20; ++i) {
    const auto cell = list.cells[11 * i];
    list.points.push_back({0.9 - 0.07 * static_cast<double>(i), 0.33, -0.41 + 0.05 * static_cast<double>(i)});
    list.scalars.push_back(0.5);
    list.cells.push_back({cell[0], cell[1], cell[2], static_cast<std::uint32_t>(list.points.size() - 1)});
  }
  expect_sane(list.build());
}

TEST(Damaged, CellsThatOverlap) {
  // Two boxes through each other: every ray sees both; the opacity is at least that of one.
  MeshBuilder builder;
  BoxOptions first, second;
  first.upper = {0.5, 1, 1};
  second.lower = {-0.4, -0.9, -0.8};
  tests::add_box(builder, first, one);
  tests::add_box(builder, second, one);
  expect_sane(builder.build());
  const auto camera = analytic::standard_cameras()[0].second;
  const Image image = tests::draw(builder.build(), kHomogeneous, camera, make_settings(Integrator::kPartial, 72, 54));
  for (int y = 0; y < 54; ++y) {
    for (int x = 0; x < 72; ++x) {
      const Ray ray = analytic::make_ray(camera, 72, 54, x, y);
      const double a = analytic::intersect_box(ray, first.lower, first.upper).length();
      const double b = analytic::intersect_box(ray, second.lower, second.upper).length();
      EXPECT_LE(image.pixel(x, y)[3], -std::expm1(-0.8 * (a + b)) + 1e-4) << x << " " << y;
      EXPECT_GE(image.pixel(x, y)[3], -std::expm1(-0.8 * std::max(a, b)) - 1e-4) << x << " " << y;
    }
  }
}

TEST(Damaged, ARandomSoupOfTetrahedra) {
  for (const int count : {1, 2, 10, 300, 1000}) expect_sane(tests::make_soup(count, 7), count < 10 ? 0 : 300);
}

TEST(Damaged, PointsShiftedAtRandomTurnCellsInsideOut) {
  CellList list = list_box(CellType::kHexahedron, wavy);
  std::mt19937 random(11);
  for (Vector3& p : list.points)
    for (double& x : p) x += 1.2 * (static_cast<double>(random()) / 4294967295.0 - 0.5);
  expect_sane(list.build());
}

TEST(Damaged, RandomConnectivity) {
  CellList list = list_box(CellType::kTetrahedron, wavy);
  std::mt19937 random(5);
  for (auto& cell : list.cells)
    for (auto& id : cell)
      if (random() % 4 == 0) id = static_cast<std::uint32_t>(random() % list.points.size());
  expect_sane(list.build());
}

TEST(Damaged, SliversSeenFromEverywhere) {
  // Bricks a million times thinner than wide: seen edge-on they must not swallow or multiply light.
  for (const double thickness : {1e-3, 1e-5, 1e-7}) {
    MeshBuilder builder;
    BoxOptions below, sheet, above;
    below.upper[2] = 0.0;
    sheet.lower[2] = 0.0;
    sheet.upper[2] = thickness;
    above.lower[2] = thickness;
    for (const BoxOptions& part : {below, sheet, above}) tests::add_box(builder, part, wavy);
    expect_like(builder.build(), builder.build());
  }
}

TEST(Damaged, WildlyDifferentCellSizes) {
  // Cells shrink by a factor of three from layer to layer, down to 1e-8 of the first.
  MeshBuilder builder;
  double x = 1.0;
  for (int layer = 0; layer < 17; ++layer) {
    BoxOptions options;
    options.bricks = {1, 4, 4};
    options.upper[0] = x;
    x = -1.0 + (x + 1.0) / 3.0;
    options.lower[0] = x;
    tests::add_box(builder, options, wavy);
  }
  expect_like(builder.build(), builder.build());
}

/// Looks along the z axis so that pixel centres fall on the grid's points, edges and faces.
class Aligned : public ::testing::TestWithParam<CellType> {};

TEST_P(Aligned, NoCracksAndNothingTwice) {
  BoxOptions options;
  options.bricks = {8, 8, 8};
  options.type = GetParam();
  const PreparedMesh mesh = prepare_mesh(make_box(options, one));
  for (const int axis : {0, 1, 2}) {
    for (const double side : {-1.0, 1.0}) {
      Camera camera;
      camera.position = camera.focal_point = {0, 0, 0};
      camera.position[axis] = 5.0 * side;
      camera.view_up = {0, 0, 0};
      camera.view_up[(axis + 1) % 3] = 1.0;
      // 33 pixels over 8.25 bricks: every fourth pixel centre lies on the lines between bricks.
      camera.parallel_scale = 33.0 / 32.0;
      for (const Integrator integrator : tests::kAllIntegrators) {
        const Image image = render(mesh, kHomogeneous, camera, make_settings(integrator, 33, 33));
        for (int y = 1; y < 32; ++y)
          for (int x = 1; x < 32; ++x)
            ASSERT_NEAR(image.pixel(x, y)[3], -std::expm1(-1.6), 1e-5)
                << "axis " << axis << " side " << side << " pixel " << x << " " << y << " " << name_of(integrator);
      }
    }
  }
}

TEST_P(Aligned, PerspectiveThroughPointsEdgesAndFaces) {
  BoxOptions options;
  options.bricks = {8, 8, 8};
  options.type = GetParam();
  const PreparedMesh mesh = prepare_mesh(make_box(options, one));
  Camera camera;
  camera.position = {0, 0, 5};
  camera.view_angle = 20.0;
  for (const Vector3& position : {Vector3{0, 0, 5}, Vector3{3, 3, 3}, Vector3{4, 4, 0}, Vector3{0.25, 5, 0.25}}) {
    camera.position = position;
    camera.view_up = position[2] == 0.0 ? Vector3{0, 0, 1} : Vector3{1, 0, 0};
    const Image image = render(mesh, kHomogeneous, camera, make_settings(Integrator::kAntiderivative, 65, 65));
    EXPECT_TRUE(analytic::shows(image, camera,
                                [](const Ray& ray) {
                                  return analytic::fill(kColor,
                                                        0.8 * analytic::intersect_box(ray, kLower, kUpper).length());
                                },
                                {1e-5, 1e-5}))
        << position[0] << " " << position[1] << " " << position[2];
  }
}

/// Counts pixels whose opacity is not what a box as it is, or up to 1e-5 larger or smaller, would show: a ray that
/// leaves along the outline, almost inside it, sees much or nothing after the least rounding.
int count_wrong(const Image& image, const Camera& camera) {
  int wrong = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = analytic::make_ray(camera, image.width, image.height, x, y);
      const auto opacity = [&](double half) {
        return -std::expm1(-0.8 * analytic::intersect_box(ray, {-half, -half, -half}, {half, half, half}).length());
      };
      const double alpha = image.pixel(x, y)[3];
      wrong += !(alpha >= opacity(1.0 - 1e-5) - 1e-5 && alpha <= opacity(1.0 + 1e-5) + 1e-5);
    }
  }
  return wrong;
}

TEST_P(Aligned, TheEyeOnPointsEdgesAndFaces) {
  BoxOptions options;
  options.bricks = {4, 4, 4};
  options.type = GetParam();
  const PreparedMesh mesh = prepare_mesh(make_box(options, one));
  const Vector3 eyes[] = {{0, 0, 0},          {0.5, -0.5, 0.5}, {0.25, 0, 0}, {0.25, 0.25, 0}, {0.2, 0.2, 0.2},
                          {0.25, 0.25, 0.25}, {1, 1, 1},        {1, 0, 0},    {1, 0.3, 0.2},   {-1, -1, 0.1}};
  for (const Vector3& eye : eyes) {
    Camera camera;
    camera.position = eye;
    camera.focal_point = {-0.37, 0.11, -0.29};
    camera.view_angle = 70.0;
    for (const Integrator integrator : tests::kAllIntegrators) {
      const Image image = render(mesh, kHomogeneous, camera, make_settings(integrator, 48, 36));
      EXPECT_TRUE(tests::is_valid_picture(image));
      EXPECT_EQ(count_wrong(image, camera), 0)
          << "eye " << eye[0] << " " << eye[1] << " " << eye[2] << " " << name_of(integrator);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, Aligned,
                         ::testing::Values(CellType::kTetrahedron, CellType::kHexahedron, CellType::kWedge,
                                           CellType::kPyramid),
                         [](const auto& test) { return "type_" + std::to_string(static_cast<int>(test.param)); });

TEST(Views, VeryFarAndVeryNear) {
  const PreparedMesh mesh = prepare_mesh(make_box({}, one));
  Camera far = analytic::standard_cameras()[0].second;
  for (double& x : far.position) x *= 1e4;
  far.view_angle = 0.0035;
  EXPECT_TRUE(analytic::shows(render(mesh, kHomogeneous, far, make_settings(Integrator::kAntiderivative, 48, 36)), far,
                              [](const Ray& ray) {
                                return analytic::fill(kColor,
                                                      0.8 * analytic::intersect_box(ray, kLower, kUpper).length());
                              },
                              {2e-3, 2e-3}));
  for (const double angle : {1e-3, 179.0}) {
    Camera camera = analytic::standard_cameras()[2].second;
    camera.view_angle = angle;
    EXPECT_TRUE(analytic::shows(render(mesh, kHomogeneous, camera, make_settings(Integrator::kPartial, 48, 36)), camera,
                                [](const Ray& ray) {
                                  return analytic::fill(kColor,
                                                        0.8 * analytic::intersect_box(ray, kLower, kUpper).length());
                                },
                                {1e-4, 1e-4}))
        << angle;
  }
}

TEST(Views, OneTetrahedronFromManySides) {
  MeshBuilder builder;
  const Vector3 corners[] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  for (const Vector3& corner : corners) builder.add_point(corner, wavy(corner));
  builder.add_cell(CellType::kTetrahedron, {0, 1, 2, 3});
  const PreparedMesh mesh = prepare_mesh(builder.build());
  const reference::Tetrahedra tetrahedra = reference::make_tetrahedra(builder.build());
  for (int i = 0; i < 40; ++i) {
    Camera camera;
    camera.position = {5.0 * std::sin(0.7 * i), 5.0 * std::cos(1.3 * i), 5.0 * std::sin(2.1 * i + 0.4)};
    camera.view_up = {0.1, 0.9, 0.2};
    if (i % 2 == 1) camera.parallel_scale = 1.8;
    const Image expected = reference::draw(tetrahedra, kVaried, {camera, 40, 40});
    for (const Integrator integrator : tests::kExactIntegrators)
      EXPECT_TRUE(agrees(render(mesh, kVaried, camera, make_settings(integrator, 40, 40)), expected, integrator))
          << i << " " << name_of(integrator);
  }
}

}  // namespace
}  // namespace tetravox::conformance
