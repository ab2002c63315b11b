#include "src/cpu/clip_intervals.h"

#include "src/scene/camera_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace tetravox::cpu {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
const Vector3 kOrigin{10.0, -20.0, 30.0};
constexpr double kScale = 2.5;  // world units of a local one

std::array<double, 12> make_test_matrix() {
  const Camera camera{{13.0, -35.0, 36.0}, {10.2, -20.1, 29.5}, {0.1, 0.2, 1.0}, 40.0, {}};
  return scene::world_from_camera(scene::make_camera_frame(kOrigin, kScale, camera, 64, 48), kOrigin, kScale);
}

Vector3 world_of(const ClipRay& ray, double z) {
  const auto m = make_test_matrix();
  const Vector3 at{ray.x_offset + ray.x_slope * z, ray.y_offset + ray.y_slope * z, z};
  Vector3 world{};
  for (int row = 0; row < 3; ++row)
    world[row] = m[4 * row] * at[0] + m[4 * row + 1] * at[1] + m[4 * row + 2] * at[2] + m[4 * row + 3];
  return world;
}

std::vector<ClipInterval> find_all(const ClipScene& scene, const ClipRay& ray) {
  ClipScratch scratch;
  std::vector<ClipInterval> intervals;
  find_intervals(scene, ray, scratch, intervals);
  return intervals;
}

/// How far inside a point is: >= 0 inside; the distance need not be true, but tells points at the border.
using Field = std::function<double(const Vector3&)>;

double field_of(const ClipPlane& plane, const Vector3& at) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) sum += plane.normal[i] * (at[i] - plane.origin[i]);
  return sum;
}

double field_of(const ClipBox& box, const Vector3& at) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) least = std::min({least, at[i] - box.bounds[i].min, box.bounds[i].max - at[i]});
  return least;
}

double field_of(const ClipSphere& sphere, const Vector3& at) {
  return sphere.radius - std::hypot(at[0] - sphere.center[0], at[1] - sphere.center[1], at[2] - sphere.center[2]);
}

/// Checks that intervals are as promised, and hold just the depths at which `field` >= 0, for many random rays in
/// [-2, 2].
void expect_inside(const Clipping& clipping, const std::vector<const PreparedGrid*>& volumes, const Field& field,
                   double margin = 1e-5) {
  const ClipScene scene = make_clip_scene(clipping, volumes, make_test_matrix());
  ClipScratch scratch;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.9, 0.9), slope(-0.5, 0.5);
  std::vector<ClipInterval> intervals;
  int inside_count = 0, outside_count = 0;
  for (int i = 0; i < 400; ++i) {
    const bool is_orthographic = i % 4 == 0;
    const ClipRay ray{place(random), is_orthographic ? 0.0 : slope(random),
                      place(random), is_orthographic ? 0.0 : slope(random),
                      -2.0,          2.0};
    intervals.clear();
    find_intervals(scene, ray, scratch, intervals);
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      ASSERT_LT(intervals[k].z_near, intervals[k].z_far);
      ASSERT_GE(intervals[k].z_near, k == 0 ? -2.0f : std::nextafter(intervals[k - 1].z_far, 3.0f));
      ASSERT_LE(intervals[k].z_far, 2.0f);
    }
    for (double z = -1.999; z < 2.0; z += 0.0107) {
      const double value = field(world_of(ray, z));
      if (std::abs(value) < margin) continue;
      const bool is_inside = std::any_of(intervals.begin(), intervals.end(),
                                         [&](const ClipInterval& at) { return z >= at.z_near && z < at.z_far; });
      ASSERT_EQ(is_inside, value > 0.0) << "ray " << i << ", depth " << z << ", field " << value;
      ++(is_inside ? inside_count : outside_count);
    }
  }
  EXPECT_GT(inside_count, 500) << "the test meets both sides";
  EXPECT_GT(outside_count, 500);
}

const ClipPlane kPlane{{10.3, -20.2, 30.1}, {1.0, -3.0, 0.5}};
const ClipBox kBox{{{{8.9, 11.7}, {-21.5, -19.0}, {28.6, 31.0}}}};
const ClipSphere kSphere{{10.4, -19.7, 30.3}, 1.6};

TEST(ClipIntervals, WithoutShapesEverythingIsKept) {
  const ClipScene scene = make_clip_scene({}, {}, make_test_matrix());
  const std::vector<ClipInterval> intervals =
      find_all(scene, {0.1, 0.2, 0.3, 0.4, -1.5, std::numeric_limits<double>::infinity()});
  ASSERT_EQ(intervals.size(), 1u);
  EXPECT_EQ(intervals[0].z_near, -1.5f);
  EXPECT_EQ(intervals[0].z_far, std::numeric_limits<float>::max());
}

TEST(ClipIntervals, PlanesBoxesAndSpheresAreWherePointsSay) {
  const std::vector<const PreparedGrid*> none(1);
  expect_inside({{{kPlane}}}, none, [](const Vector3& at) { return field_of(kPlane, at); });
  expect_inside({{{kBox}}}, none, [](const Vector3& at) { return field_of(kBox, at); });
  expect_inside({{{kSphere}}}, none, [](const Vector3& at) { return field_of(kSphere, at); });
}

TEST(ClipIntervals, ComplementsAreTheRest) {
  const std::vector<const PreparedGrid*> none(1);
  expect_inside({{{kPlane, false}}}, none, [](const Vector3& at) { return -field_of(kPlane, at); });
  expect_inside({{{kBox, false}}}, none, [](const Vector3& at) { return -field_of(kBox, at); });
  expect_inside({{{kSphere, false}}}, none, [](const Vector3& at) { return -field_of(kSphere, at); });
}

TEST(ClipIntervals, ShapesAgreeOrAnyDoes) {
  const std::vector<const PreparedGrid*> none(3);
  const std::vector<ClipShape> shapes{{kPlane}, {kBox, false}, {kSphere}};
  const auto fields = [](const Vector3& at) {
    return std::array<double, 3>{field_of(kPlane, at), -field_of(kBox, at), field_of(kSphere, at)};
  };
  expect_inside({shapes, true}, none, [&](const Vector3& at) { return std::ranges::max(fields(at)); });
  // The three together leave little: a smaller hole.
  ClipBox hole = kBox;
  hole.bounds[0].max = 10.2;
  expect_inside({{{kPlane, false}, {hole, false}, {kSphere}}}, none, [&](const Vector3& at) {
    return std::min({-field_of(kPlane, at), -field_of(hole, at), field_of(kSphere, at)});
  });
}

/// Shapes in the camera's frame itself.
std::vector<ClipInterval> find_in_camera(const ClipShape& shape, ClipRay ray) {
  const std::array<double, 12> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const std::vector<const PreparedGrid*> none(1);
  const ClipScene scene = make_clip_scene({{shape}}, none, identity);
  ray.z_end = 4.0;
  return find_all(scene, ray);
}

TEST(ClipIntervals, RaysParallelToPlanesAreOnOneSide) {
  const ClipShape plane{ClipPlane{{0.5, 0, 0}, {1, 0, 0}}};
  EXPECT_EQ(find_in_camera(plane, {0.6, 0, 0, 0.3}).size(), 1u);
  EXPECT_EQ(find_in_camera(plane, {0.5, 0, 0, 0}).size(), 1u) << "in the plane is inside";
  EXPECT_TRUE(find_in_camera(plane, {0.4, 0, 0, 0.3}).empty());
  EXPECT_EQ(find_in_camera(plane, {0.4, 1e-320, 0, 0.3}).size(), 0u) << "almost parallel";
  const ClipShape box{ClipBox{{{{0, 1}, {0, 1}, {1, 2}}}}};
  EXPECT_EQ(find_in_camera(box, {0, 0, 1, 0}).size(), 1u) << "along an edge";
  EXPECT_TRUE(find_in_camera(box, {-1e-9, 0, 1, 0}).empty());
}

TEST(ClipIntervals, TangentsAreNotCut) {
  const ClipSphere sphere{{0, 0, 2}, 1.0};
  EXPECT_TRUE(find_in_camera({sphere}, {1, 0, 0, 0}).empty());
  const auto outside = find_in_camera({sphere, false}, {1, 0, 0, 0});
  ASSERT_EQ(outside.size(), 1u);
  EXPECT_EQ(outside[0].z_near, 0.0f);
  EXPECT_EQ(outside[0].z_far, 4.0f);
  const auto inside = find_in_camera({sphere}, {0.6, 0, 0, 0});
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_FLOAT_EQ(inside[0].z_near, 1.2f);
  EXPECT_FLOAT_EQ(inside[0].z_far, 2.8f);
}

TEST(ClipIntervals, SmallSpheresOfADistantEyeAreExact) {
  const double x = 3e5, radius = 1e-3;
  const auto inside = find_in_camera({ClipSphere{{x, 0, 2}, radius}}, {x, 0, 0, 0});
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_NEAR(inside[0].z_far - inside[0].z_near, 2.0 * radius, 1e-6);
}

/// A grid in the middle of the test's frame, turned a little.
template <class T>
GridData make_grid(const std::vector<T>& values, ScalarType type, std::array<std::uint32_t, 3> dimensions) {
  GridData grid;
  grid.shape.dimensions = dimensions;
  grid.shape.direction = {0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1};
  for (int axis = 0; axis < 3; ++axis) grid.shape.spacing[axis] = 3.0 / dimensions[axis];
  grid.shape.origin = {9.7, -21.8, 28.6};
  grid.type = type;
  grid.values = std::as_bytes(std::span<const T>(values));
  grid.array_name = "mask";
  return grid;
}

Vector3 world_of(const GridShape& shape, std::uint32_t i, std::uint32_t j, std::uint32_t k) {
  const std::array<std::uint32_t, 3> index{i, j, k};
  Vector3 world = shape.origin;
  for (int row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis)
      world[row] +=
          shape.direction[3 * row + axis] *
          (shape.coordinates[axis].empty() ? shape.spacing[axis] * index[axis] : shape.coordinates[axis][index[axis]]);
  return world;
}

/// The field minus `value` at a point, by searching the cell; -1 outside and where a value is missing. `values`: as
/// floats.
double sample_grid(const GridData& grid, const std::vector<float>& values, double value, const Vector3& world) {
  const grid::GridFrame frame = grid::make_grid_frame(grid.shape);
  std::array<std::size_t, 3> cell{};
  std::array<double, 3> at{};
  for (int axis = 0; axis < 3; ++axis) {
    double u = 0.0;
    for (int i = 0; i < 3; ++i) u += frame.grid_from_world[3 * axis + i] * (world[i] - frame.origin[i]);
    if (u < 0.0 || u > frame.plane(axis, grid.shape.dimensions[axis] - 1)) return -1.0;
    while (cell[axis] + 2 < grid.shape.dimensions[axis] &&
           frame.plane(axis, static_cast<std::int64_t>(cell[axis]) + 1) <= u)
      ++cell[axis];
    const double low = frame.plane(axis, static_cast<std::int64_t>(cell[axis]));
    at[axis] = (u - low) / (frame.plane(axis, static_cast<std::int64_t>(cell[axis]) + 1) - low);
  }
  const auto dimensions = grid.value_dimensions();
  if (grid.association == Association::kCell) {
    const float held = values[(cell[2] * dimensions[1] + cell[1]) * dimensions[0] + cell[0]];
    return held >= value ? 1.0 : -1.0;
  }
  double sum = -value;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<std::size_t, 3> node = cell;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_upper = corner >> axis & 1;
      weight *= is_upper ? at[axis] : 1.0 - at[axis];
      node[axis] += is_upper;
    }
    const float held = values[(node[2] * dimensions[1] + node[1]) * dimensions[0] + node[0]];
    if (std::isnan(held)) return -1.0;
    sum += weight * held;
  }
  return sum;
}

template <class T>
std::vector<T> make_noise(std::size_t count, double highest, double missing_share = 0.0) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> value(0.0, highest), share(0.0, 1.0);
  std::vector<T> values(count);
  for (T& held : values) {
    held = static_cast<T>(value(random));
    if (share(random) < missing_share) held = static_cast<T>(kMissing);
  }
  return values;
}

/// At the border of the grid or of a cell with a missing value the field jumps: samples there are few, and none lies
/// within rounding of it.
void expect_field_inside(const GridData& grid, const std::vector<float>& values, double value) {
  const PreparedGrid prepared = prepare_grid(grid);
  const std::vector<const PreparedGrid*> volumes{&prepared};
  expect_inside({{{ClipVolume{"", "", value}}}}, volumes,
                [&](const Vector3& at) { return sample_grid(grid, values, value, at); });
}

TEST(ClipIntervals, VolumesAreWhereTheirFieldSays) {
  const std::array<std::uint32_t, 3> dimensions{19, 12, 10};
  const auto values = make_noise<float>(19 * 12 * 10, 1.0);
  expect_field_inside(make_grid(values, ScalarType::kFloat32, dimensions), values, 0.45);
}

TEST(ClipIntervals, MissingValuesOfVolumesAreOutside) {
  const std::array<std::uint32_t, 3> dimensions{12, 9, 17};
  const auto values = make_noise<float>(12 * 9 * 17, 1.0, 0.03);
  expect_field_inside(make_grid(values, ScalarType::kFloat32, dimensions), values, 0.4);
}

TEST(ClipIntervals, VolumesOfBytesOnUnevenAxes) {
  const std::array<std::uint32_t, 3> dimensions{10, 11, 12};
  const auto bytes = make_noise<std::uint8_t>(10 * 11 * 12, 256.0);
  GridData grid = make_grid(bytes, ScalarType::kUint8, dimensions);
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t i = 0; i < dimensions[axis]; ++i)
      grid.shape.coordinates[axis].push_back(0.02 * i * i + 0.05 * i);
  expect_field_inside(grid, {bytes.begin(), bytes.end()}, 110.0);
}

TEST(ClipIntervals, CellDataOfVolumesAreConstantInTheirCell) {
  const std::array<std::uint32_t, 3> dimensions{12, 10, 9};
  const auto bytes = make_noise<std::uint8_t>(11 * 9 * 8, 2.0);
  GridData grid = make_grid(bytes, ScalarType::kUint8, dimensions);
  grid.association = Association::kCell;
  expect_field_inside(grid, {bytes.begin(), bytes.end()}, 1.0);
}

TEST(ClipIntervals, ValuesEqualToThatOfAVolumeAreInside) {
  const std::vector<float> values(9 * 9 * 9, 0.1f);
  const PreparedGrid grid = prepare_grid(make_grid(values, ScalarType::kFloat32, {9, 9, 9}));
  const std::vector<const PreparedGrid*> volumes{&grid};
  for (const double value : {static_cast<double>(0.1f), 0.11}) {
    const ClipScene scene = make_clip_scene({{{ClipVolume{"", "", value}}}}, volumes, make_test_matrix());
    EXPECT_EQ(find_all(scene, {0.01, 0.0, 0.02, 0.0, -2.0, 2.0}).size(), value < 0.105 ? 1u : 0u);
  }
}

TEST(ClipIntervals, ADistanceVolumeIsItsSphere) {
  const std::array<std::uint32_t, 3> dimensions{48, 48, 48};
  std::vector<float> values(48 * 48 * 48);
  GridData grid = make_grid(values, ScalarType::kFloat32, dimensions);
  const ClipSphere sphere{world_of(grid.shape, 24, 23, 24), 1.1};
  for (std::uint32_t k = 0; k < 48; ++k)
    for (std::uint32_t j = 0; j < 48; ++j)
      for (std::uint32_t i = 0; i < 48; ++i)
        values[(k * 48 + j) * 48 + i] = static_cast<float>(field_of(sphere, world_of(grid.shape, i, j, k)));
  const PreparedGrid prepared = prepare_grid(grid);
  const std::vector<const PreparedGrid*> volumes{&prepared, nullptr};
  // Linear interpolation of the distance errs by about spacing^2 / radius.
  const double error = 2.0 * std::pow(3.0 / 48, 2) / 1.1;
  expect_inside(
      {{{ClipVolume{"", "", 0.0}}, {kPlane}}}, volumes,
      [&](const Vector3& at) { return std::min(field_of(sphere, at), field_of(kPlane, at)); }, error);
  expect_inside(
      {{{ClipVolume{"", "", 0.0}, false}, {kPlane, false}}, true}, volumes,
      [&](const Vector3& at) { return std::max(-field_of(sphere, at), -field_of(kPlane, at)); }, error);
}

}  // namespace
}  // namespace tetravox::cpu
