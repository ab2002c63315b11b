/// Lines through meshes and grids against sums in double precision that know nothing of walks.

#include "src/cpu/shadow_rays.h"

#include "src/cpu/grid_shadows.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/mesh_shadows.h"
#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace tetravox::cpu {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector3 moved(const Vector3& a, double t, const Vector3& d) {
  return {a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]};
}

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : twister_(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(twister_); }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(twister_); }

  /// Every third one along an axis or a diagonal of the lattice.
  Vector3 direction() {
    Vector3 d{};
    do {
      for (double& x : d) x = below(3) == 0 ? static_cast<double>(below(3)) - 1.0 : in(-1.0, 1.0);
    } while (dot(d, d) < 0.01);
    const double length = std::sqrt(dot(d, d));
    for (double& x : d) x /= length;
    return d;
  }

 private:
  std::mt19937 twister_;
};

Vector3 place_of(const Vertex& v) { return {v.x, v.y, v.z}; }

/// The extinction of stored scalars, by the points of the function.
struct Medium {
  OpticalFunction function;
  optics::ScalarMap map;
  optics::ExtinctionIntegral integral{function, map};

  double extinction(double stored) const {
    return eval_optical_function(function, map.offset + stored * map.scale).extinction;
  }
};

// ---- meshes ----

/// Points at random, regular points (so that lines along axes meet edges and vertices), cell data, cells that overlap.
enum class MeshKind { kJittered, kRegular, kCells, kSoup };

/// A box of tetrahedra with a hole and a notch.
PreparedMesh make_test_mesh(MeshKind kind) {
  if (kind == MeshKind::kSoup) return prepare_mesh(tests::make_soup(40, 6));
  tests::BoxOptions options;
  options.bricks = {5, 4, 6};
  options.type = CellType::kTetrahedron;
  options.association = kind == MeshKind::kCells ? Association::kCell : Association::kPoint;
  options.is_hole = [](int i, int j, int k) { return (i == 2 && j == 1 && k >= 2 && k <= 3) || (i == 4 && j == 3); };
  MeshData mesh = tests::make_box(options, tests::make_random_field(5, 1.5));
  auto points = std::make_shared<std::vector<double>>(mesh.points.begin(), mesh.points.end());
  Dice dice(9);
  for (double& x : *points)
    if (kind != MeshKind::kRegular && std::abs(x) < 0.99) x += dice.in(-0.05, 0.05);
  mesh.points = *points;
  const PreparedMesh prepared = prepare_mesh(mesh);
  return prepared;
}

/// Cells of a prepared mesh by their vertices, found from the faces they share: [cells][4].
std::vector<std::array<std::uint32_t, 4>> find_cells(const PreparedMesh& mesh) {
  std::vector<std::array<std::uint32_t, 4>> cells(mesh.cells.size());
  std::vector<bool> is_known(mesh.cells.size());
  std::vector<std::uint32_t> open;
  const auto add = [&](std::uint32_t cell, const std::array<std::uint32_t, 3>& face) {
    if (cell == kNoCell || is_known[cell]) return;
    cells[cell] = {face[0], face[1], face[2], mesh.cells[cell].vertex_xor ^ face[0] ^ face[1] ^ face[2]};
    std::sort(cells[cell].begin(), cells[cell].end());
    is_known[cell] = true;
    open.push_back(cell);
  };
  for (const BoundaryFace& face : mesh.boundary) add(face.cell, face.vertices);
  while (!open.empty()) {
    const std::uint32_t cell = open.back();
    open.pop_back();
    for (std::size_t r = 0; r < 4; ++r) {
      std::array<std::uint32_t, 3> face{};
      for (std::size_t i = 0, n = 0; i < 4; ++i)
        if (i != r) face[n++] = cells[cell][i];
      add(mesh.cells[cell].neighbours[r], face);
    }
  }
  EXPECT_EQ(std::count(is_known.begin(), is_known.end(), false), 0);
  return cells;
}

/// The part of a ray from `place` along `direction`, both local, that lies in a tetrahedron whose faces are moved out
/// by `margin`.
DepthRange clip_with(const std::array<Vector3, 4>& corners, const Vector3& place, const Vector3& direction,
                     double margin) {
  DepthRange range{0.0, kFar};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3 &a = corners[(i + 1) % 4], &b = corners[(i + 2) % 4], &c = corners[(i + 3) % 4];
    Vector3 normal = cross(difference(b, a), difference(c, a));
    if (dot(normal, difference(corners[i], a)) < 0.0) normal = {-normal[0], -normal[1], -normal[2]};
    const double at = dot(normal, difference(place, a)) + margin * std::sqrt(dot(normal, normal));
    const double slope = dot(normal, direction);
    if (slope == 0.0 && at < 0.0) return {};
    if (slope > 0.0) range.begin = std::max(range.begin, -at / slope);
    if (slope < 0.0) range.end = std::min(range.end, -at / slope);
  }
  return range;
}

double scalar_in(const std::array<Vector3, 4>& corners, const std::array<double, 4>& scalars, const Vector3& place) {
  const auto volume = [](const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
    return dot(cross(difference(b, a), difference(c, a)), difference(d, a));
  };
  const double all = volume(corners[0], corners[1], corners[2], corners[3]);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<Vector3, 4> replaced = corners;
    replaced[i] = place;
    sum += scalars[i] * volume(replaced[0], replaced[1], replaced[2], replaced[3]) / all;
  }
  return sum;
}

class MeshLines : public ::testing::TestWithParam<MeshKind> {
 protected:
  MeshLines()
      : mesh_(make_test_mesh(GetParam())),
        cells_(find_cells(mesh_)),
        tree_(mesh_),
        medium_{{{{0.0, 0.2, {}}, {0.45, 2.0, {}}, {0.5, 6.0, {}}, {0.5, 0.5, {}}, {1.0, 4.0, {}}}},
                {mesh_.scalar_offset, mesh_.scalar_scale}} {}

  /// From all cells, each a little larger or smaller than it is.
  Transmission sum_cells(const Vector3& place, const Vector3& to_light, double distance, double margin = 0.0) const {
    Transmission sum;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      std::array<Vector3, 4> corners;
      std::array<double, 4> scalars{};
      for (std::size_t k = 0; k < 4; ++k) {
        corners[k] = place_of(mesh_.vertices[cells_[i][k]]);
        scalars[k] = mesh_.vertices[cells_[i][k]].scalar;
      }
      DepthRange range = clip_with(corners, place, to_light, margin);
      range.end = std::min(range.end, distance);
      if (!(range.begin < range.end)) continue;
      const auto scalar_at = [&](double t) {
        const bool is_cell = GetParam() == MeshKind::kCells;
        return is_cell ? mesh_.cell_scalars[i] : scalar_in(corners, scalars, moved(place, t, to_light));
      };
      const double near = scalar_at(range.begin), far = scalar_at(range.end);
      sum.optical_depth += (range.end - range.begin) * mesh_.world_per_local * medium_.integral.mean(near, far);
      for (const SurfaceSheet& sheet : sheets_)
        if ((near < sheet.value) != (far < sheet.value) && (far < sheet.value || sheet.is_two_sided))
          sum.through_surfaces *= 1.0 - static_cast<double>(sheet.opacity);
    }
    return sum;
  }

  ShadowOptics optics() const {
    ShadowOptics optics;
    optics.extinction = &medium_.integral;
    optics.surfaces = sheets_;
    return optics;
  }

  Transmission trace(const Vector3& place, const Vector3& to_light, double distance) const {
    const ShadowLine line = make_shadow_line(place, {-to_light[0], -to_light[1], -to_light[2]}, mesh_.world_per_local);
    const double z_light = -distance * std::abs(to_light[static_cast<std::size_t>(line.axes[2])]);
    const std::array<DepthRange, 1> kept{DepthRange{z_light, 0.0}};
    Transmission sum;
    MeshShadows medium(mesh_, tree_, optics(), {}, false);
    medium.gather(line, kept, sum);
    return sum;
  }

  PreparedMesh mesh_;
  std::vector<std::array<std::uint32_t, 4>> cells_;
  FaceTree tree_;
  Medium medium_;
  std::vector<SurfaceSheet> sheets_;
};

TEST_P(MeshLines, AgreeWithTheSumOverAllCells) {
  Dice dice(21);
  double deepest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3 place{dice.in(-0.7, 0.7), dice.in(-0.7, 0.7), dice.in(-0.7, 0.7)}, to_light = dice.direction();
    const double distance = i % 2 == 0 ? kFar : dice.in(0.01, 1.0);
    const double wanted = sum_cells(place, to_light, distance).optical_depth;
    deepest = std::max(deepest, wanted);
    EXPECT_NEAR(trace(place, to_light, distance).optical_depth, wanted, 1e-9 * (1.0 + wanted)) << i;
  }
  EXPECT_GT(deepest, 3.0);
}

/// Places on vertices, on edges, on faces; light towards other vertices, along edges and in faces.
TEST_P(MeshLines, MeetVerticesEdgesAndFacesOnce) {
  Dice dice(22);
  const auto pick = [&](std::size_t cell) {
    Vector3 sum{};
    const std::size_t count = 1 + dice.below(3);
    for (std::size_t k = 0; k < count; ++k)
      sum = moved(sum, 1.0 / static_cast<double>(count), place_of(mesh_.vertices[cells_[cell][k]]));
    for (double& x : sum) x = static_cast<float>(x);
    return sum;
  };
  int compared = 0;
  for (int i = 0; i < 6000; ++i) {
    const Vector3 place = pick(dice.below(cells_.size())), aim = pick(dice.below(cells_.size()));
    Vector3 to_light = i % 3 == 0 ? dice.direction() : difference(aim, place);
    const double length = std::sqrt(dot(to_light, to_light));
    if (length < 0.01) continue;
    for (double& x : to_light) x /= length;
    // Along faces a line may pass on either side of each cell.
    constexpr double kMargin = 1e-6, kError = 1e-3;  // far more than a place in float is off, and what that may do
    const double low = sum_cells(place, to_light, kFar, -kMargin).optical_depth;
    const double high = sum_cells(place, to_light, kFar, kMargin).optical_depth;
    compared += high - low < kError;
    const double found = trace(place, to_light, kFar).optical_depth;
    EXPECT_GE(found, low - kError) << i;
    EXPECT_LE(found, high + kError) << i;
  }
  EXPECT_GT(compared, 1500);
}

/// Lines of parallel light find their faces in another way.
TEST_P(MeshLines, OfParallelLightAreTheSame) {
  Dice dice(24);
  for (int i = 0; i < 40; ++i) {
    const Vector3 travel = dice.direction();
    MeshShadows plain(mesh_, tree_, optics(), {}, false), prepared(mesh_, tree_, optics(), {}, false);
    prepared.expect_parallel(0, travel);
    for (int k = 0; k < 60; ++k) {
      Vector3 place{dice.in(-0.7, 0.7), dice.in(-0.7, 0.7), dice.in(-0.7, 0.7)};
      if (k % 3 == 0) place = place_of(mesh_.vertices[dice.below(mesh_.vertices.size())]);
      ShadowLine line = make_shadow_line(place, travel, mesh_.world_per_local);
      const std::array<DepthRange, 1> kept{DepthRange{-kFar, 0.0}};
      Transmission one, other;
      plain.gather(line, kept, one);
      line.light = 0;
      prepared.gather(line, kept, other);
      EXPECT_NEAR(other.optical_depth, one.optical_depth, 1e-12 * (1.0 + one.optical_depth));
    }
  }
}

TEST_P(MeshLines, MeetSurfacesFromBothSides) {
  if (GetParam() == MeshKind::kCells) return;  // they have none
  sheets_ = {{-0.2f, {}, {}, 0.5f, true}, {0.1f, {}, {}, 0.25f, false}, {0.3f, {}, {}, 1.0f, false}};
  for (SurfaceSheet& sheet : sheets_) sheet.value = medium_.map.stored_from_value(0.5 + sheet.value);
  Dice dice(23);
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3 place{dice.in(-0.6, 0.6), dice.in(-0.6, 0.6), dice.in(-0.6, 0.6)}, to_light = dice.direction();
    const double wanted = sum_cells(place, to_light, kFar).through_surfaces;
    const double found = trace(place, to_light, kFar).through_surfaces;
    met += wanted < 1.0;
    EXPECT_NEAR(found, wanted, 1e-12) << i;
  }
  EXPECT_GT(met, 1000);
}

const auto kNameOfMesh = [](const auto& test) {
  constexpr std::array<const char*, 4> kNames{"jittered", "regular", "cells", "soup"};
  return kNames[static_cast<std::size_t>(test.param)];
};
INSTANTIATE_TEST_SUITE_P(All, MeshLines,
                         ::testing::Values(MeshKind::kJittered, MeshKind::kRegular, MeshKind::kCells, MeshKind::kSoup),
                         kNameOfMesh);

// ---- grids ----

class GridLines : public ::testing::TestWithParam<int> {
 protected:
  GridLines()
      : grid_(prepare_grid(make_data(GetParam()))),
        medium_{{{{0.0, 0.2, {}}, {0.45, 2.0, {}}, {0.7, 0.5, {}}, {1.0, 4.0, {}}}},
                {grid_.scalar_offset, grid_.scalar_scale}} {
    points_ = optics::build_control_point_table(medium_.function, medium_.map);
    optics::build_steepness_table(points_, medium_.map.stored_from_value(grid_.scalar_range.min),
                                  medium_.map.stored_from_value(grid_.scalar_range.max), steepness_);
  }

  static bool is_cell() { return GetParam() == 3; }

  /// Even; turned and uneven; with missing values; cell data.
  static GridData make_data(int kind) {
    tests::GridOptions options;
    options.dimensions = {19, 12, 10};
    if (kind == 1) {
      options.direction = {0.8, -0.6, 0.0, 0.48, 0.64, -0.6, 0.36, 0.48, 0.8};
      options.fractions = {tests::growing_fractions(19, 5.0), {}, tests::growing_fractions(10, 0.4)};
    }
    if (kind == 3) options.association = Association::kCell;
    const tests::Field field = tests::make_random_field(8, 1.2);
    return tests::make_grid(options, [&](const Vector3& p) {
      const bool is_missing = kind == 2 && std::abs(p[0]) < 0.15 && p[1] > 0.3;
      return is_missing ? std::numeric_limits<double>::quiet_NaN() : field(p);
    });
  }

  Transmission trace(const Vector3& place, const Vector3& to_light, double distance) const {
    const scene::FilteredField unfiltered;
    const grid::GridFrame frame = grid::make_grid_frame(grid_.data.shape);
    const grid::BlockReader reader(grid_.data, {grid_.scalar_offset, grid_.scalar_scale});
    PlannedGrid planned;
    planned.frame = &frame;
    planned.field.kernels = &kernels_for("");
    planned.field.reader = &reader;
    planned.field.is_constant = is_cell();
    planned.field.allowed_rate = scene::allowed_rate_of(1e-6, 3.0);
    planned.sources = {&grid_, &unfiltered, &steepness_, 1e-6f, 3.0, is_cell(), false, {}};
    scene::PlanSettings settings;
    settings.tolerance = 1e-6;
    settings.wants_gradients = true;
    const std::vector<scene::BrickPlan> plans = scene::plan_bricks(planned.sources, settings);
    planned.plans = plans;
    ShadowOptics optics;
    optics.extinction = &medium_.integral;
    const scene::LocalFrame local = scene::find_local_frame(grid_);
    const ShadowLine line =
        make_shadow_line(local_of(place), {-to_light[0], -to_light[1], -to_light[2]}, local.world_per_local);
    const double z_light =
        -distance / local.world_per_local * std::abs(to_light[static_cast<std::size_t>(line.axes[2])]);
    const std::array<DepthRange, 1> kept{DepthRange{z_light, 0.0}};
    Transmission sum;
    GridShadows(planned, local, optics, {planned.field.allowed_rate, 256.0f, {}}).gather(line, kept, sum);
    return sum;
  }

  Vector3 local_of(const Vector3& world) const {
    const scene::LocalFrame local = scene::find_local_frame(grid_);
    Vector3 at = difference(world, local.origin);
    for (double& x : at) x /= local.world_per_local;
    return at;
  }

  /// Stored scalar at a world position; NaN outside.
  double scalar_at(const Vector3& world) const {
    const grid::GridFrame frame = grid::make_grid_frame(grid_.data.shape);
    const grid::BlockReader reader(grid_.data, {grid_.scalar_offset, grid_.scalar_scale});
    grid::Block block{{}, {2, 2, 2}};
    std::array<double, 3> t{};
    for (int axis = 0; axis < 3; ++axis) {
      double u = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
        u += frame.grid_from_world[3 * static_cast<std::size_t>(axis) + i] * (world[i] - frame.origin[i]);
      const std::int64_t cells = grid_.data.shape.dimensions[axis] - 1;
      if (!(u >= 0.0 && u <= frame.plane(axis, cells))) return std::numeric_limits<double>::quiet_NaN();
      std::int64_t cell = 0;
      while (cell + 1 < cells && frame.plane(axis, cell + 1) <= u) ++cell;
      block.first[axis] = cell;
      t[axis] =
          (u - frame.plane(axis, cell)) / (static_cast<double>(frame.plane(axis, cell + 1)) - frame.plane(axis, cell));
    }
    if (is_cell()) block.count = {1, 1, 1};
    std::array<float, 8> values{};
    reader.read(block, values.data());
    if (is_cell()) return values[0];
    double sum = 0.0;
    for (std::size_t i = 0; i < 8; ++i)
      sum += values[i] * (i & 1 ? t[0] : 1.0 - t[0]) * (i & 2 ? t[1] : 1.0 - t[1]) * (i & 4 ? t[2] : 1.0 - t[2]);
    return sum;
  }

  double integrate(const Vector3& place, const Vector3& to_light, double distance) const {
    constexpr int kSteps = 6000;
    const double length = std::min(distance, 4.0);
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double scalar = scalar_at(moved(place, length * (i + 0.5) / kSteps, to_light));
      if (scalar == scalar) sum += medium_.extinction(scalar) * length / kSteps;
    }
    return sum;
  }

  PreparedGrid grid_;
  Medium medium_;
  optics::ControlPointTable points_;
  optics::SteepnessTable steepness_;
};

TEST_P(GridLines, AgreeWithASumOfSamples) {
  Dice dice(31);
  for (int i = 0; i < 120; ++i) {
    const Vector3 place{dice.in(-1.0, 1.0), dice.in(-1.0, 1.0), dice.in(-1.0, 1.0)}, to_light = dice.direction();
    const double distance = i % 2 == 0 ? kFar : dice.in(0.01, 1.0);
    const double wanted = integrate(place, to_light, distance);
    EXPECT_NEAR(trace(place, to_light, distance).optical_depth, wanted, 6e-3) << i;  // steps at borders: samples' width
  }
}

const auto kNameOfGrid = [](const auto& test) {
  constexpr std::array<const char*, 4> kNames{"even", "turned_uneven", "missing", "cells"};
  return kNames[static_cast<std::size_t>(test.param)];
};
INSTANTIATE_TEST_SUITE_P(All, GridLines, ::testing::Range(0, 4), kNameOfGrid);

}  // namespace
}  // namespace tetravox::cpu
