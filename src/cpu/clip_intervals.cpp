#include "src/cpu/clip_intervals.h"

#include "src/support/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tetravox::cpu {
namespace {

using Row = std::array<double, 3>;

double dot(const Row& a, const Row& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The world's direction `normal` as a function of camera coordinates: normal * world_from_camera.
Row turn_normal(const Row& normal, const std::array<double, 12>& world_from_camera) {
  Row turned{};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) turned[column] += normal[row] * world_from_camera[4 * row + column];
  return turned;
}

/// World position relative to the frame's origin.
Row offset_from_origin(const Vector3& world, const std::array<double, 12>& world_from_camera) {
  return {world[0] - world_from_camera[3], world[1] - world_from_camera[7], world[2] - world_from_camera[11]};
}

ClipScene::Plane place(const ClipPlane& plane, const std::array<double, 12>& world_from_camera) {
  const double length = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
  const Row unit{plane.normal[0] / length, plane.normal[1] / length, plane.normal[2] / length};
  return {turn_normal(unit, world_from_camera), -dot(unit, offset_from_origin(plane.origin, world_from_camera))};
}

ClipScene::Box place(const ClipBox& box, const std::array<double, 12>& world_from_camera) {
  ClipScene::Box placed;
  for (int axis = 0; axis < 3; ++axis) {
    for (int column = 0; column < 3; ++column) placed.normals[axis][column] = world_from_camera[4 * axis + column];
    const double origin = world_from_camera[4 * axis + 3];
    placed.bounds[axis] = {box.bounds[axis].min - origin, box.bounds[axis].max - origin};
  }
  return placed;
}

/// The frame is turned and scaled alike along all axes: its transposed matrix / scale^2 leads back.
ClipScene::Sphere place(const ClipSphere& sphere, const std::array<double, 12>& world_from_camera) {
  const Row x{world_from_camera[0], world_from_camera[4], world_from_camera[8]};
  const double scale = std::sqrt(dot(x, x));
  Row center = turn_normal(offset_from_origin(sphere.center, world_from_camera), world_from_camera);
  for (double& coordinate : center) coordinate /= scale * scale;
  return {center, sphere.radius / scale};
}

ClipScene::Volume place(const PreparedGrid& grid, double value, const std::array<double, 12>& world_from_camera) {
  ClipScene::Volume placed{ClipField(grid, value), {}};
  const grid::GridFrame& frame = placed.field.frame();
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i < 3; ++i) {
      const double element = frame.grid_from_world[3 * row + i];
      for (int column = 0; column < 3; ++column)
        placed.grid_from_camera[4 * row + column] += element * world_from_camera[4 * i + column];
      placed.grid_from_camera[4 * row + 3] += element * (world_from_camera[4 * i + 3] - frame.origin[i]);
    }
  return placed;
}

/// normal * (position of the ray) = constant + slope * z.
struct Along {
  double constant = 0.0, slope = 0.0;
};

Along along_ray(const Row& normal, const ClipRay& ray) {
  return {normal[0] * ray.x_offset + normal[1] * ray.y_offset,
          normal[0] * ray.x_slope + normal[1] * ray.y_slope + normal[2]};
}

/// Cuts `range` with low <= along <= high; it may become empty (begin >= end).
void cut_range(const Along& along, double low, double high, DepthRange& range) {
  if (along.slope == 0.0) {
    if (!(along.constant >= low && along.constant <= high)) range.end = range.begin;
    return;
  }
  const double first = (low - along.constant) / along.slope, last = (high - along.constant) / along.slope;
  range.begin = std::max(range.begin, std::min(first, last));
  range.end = std::min(range.end, std::max(first, last));
}

void find_inside(const ClipScene::Plane& plane, const ClipRay& ray, DepthRange range, DepthRanges& ranges) {
  cut_range(along_ray(plane.normal, ray), -plane.constant, std::numeric_limits<double>::infinity(), range);
  append_range(ranges, range.begin, range.end);
}

void find_inside(const ClipScene::Box& box, const ClipRay& ray, DepthRange range, DepthRanges& ranges) {
  for (int axis = 0; axis < 3; ++axis)
    cut_range(along_ray(box.normals[axis], ray), box.bounds[axis].min, box.bounds[axis].max, range);
  append_range(ranges, range.begin, range.end);
}

/// By the point of the ray that is nearest to the centre, which keeps its precision for a distant eye and a small
/// sphere (Haines, Guenther, Akenine-Moeller 2019).
void find_inside(const ClipScene::Sphere& sphere, const ClipRay& ray, const DepthRange& range, DepthRanges& ranges) {
  const Row direction{ray.x_slope, ray.y_slope, 1.0};
  const Row origin{ray.x_offset - sphere.center[0], ray.y_offset - sphere.center[1], -sphere.center[2]};
  const double squared_speed = dot(direction, direction);
  const double z_nearest = -dot(origin, direction) / squared_speed;
  const double distance =
      std::hypot(origin[0] + z_nearest * direction[0], origin[1] + z_nearest * direction[1], origin[2] + z_nearest);
  if (!(distance < sphere.radius)) return;
  const double half = std::sqrt((sphere.radius - distance) * (sphere.radius + distance) / squared_speed);
  append_range(ranges, std::max(range.begin, z_nearest - half), std::min(range.end, z_nearest + half));
}

void find_inside(const ClipScene::Volume& volume, const ClipRay& ray, const DepthRange& range, ClipField::Cache& cache,
                 DepthRanges& ranges) {
  DepthLine line;
  for (int row = 0; row < 3; ++row) {
    const Row normal{volume.grid_from_camera[4 * row], volume.grid_from_camera[4 * row + 1],
                     volume.grid_from_camera[4 * row + 2]};
    const Along along = along_ray(normal, ray);
    line.origin[row] = along.constant + volume.grid_from_camera[4 * row + 3];
    line.direction[row] = along.slope;
  }
  volume.field.find_inside(line, range.begin, range.end, cache, ranges);
}

void find_complement(const DepthRanges& ranges, const DepthRange& of, DepthRanges& complement) {
  complement.clear();
  double begin = of.begin;
  for (const DepthRange& range : ranges) {
    append_range(complement, begin, range.begin);
    begin = range.end;
  }
  append_range(complement, begin, of.end);
}

/// Leaves in `scratch.shape` where a shape keeps the ray.
void find_kept(const ClipScene::Shape& shape, const ClipRay& ray, const DepthRange& range, ClipField::Cache& cache,
               ClipScratch& scratch) {
  scratch.shape.clear();
  if (const auto* plane = std::get_if<ClipScene::Plane>(&shape.shape))
    find_inside(*plane, ray, range, scratch.shape);
  else if (const auto* box = std::get_if<ClipScene::Box>(&shape.shape))
    find_inside(*box, ray, range, scratch.shape);
  else if (const auto* sphere = std::get_if<ClipScene::Sphere>(&shape.shape))
    find_inside(*sphere, ray, range, scratch.shape);
  else
    find_inside(std::get<ClipScene::Volume>(shape.shape), ray, range, cache, scratch.shape);
  if (shape.keeps_inside) return;
  find_complement(scratch.shape, range, scratch.other);
  std::swap(scratch.shape, scratch.other);
}

void find_intersection(const DepthRanges& a, const DepthRanges& b, DepthRanges& both) {
  both.clear();
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    append_range(both, std::max(a[i].begin, b[j].begin), std::min(a[i].end, b[j].end));
    if (a[i].end < b[j].end)
      ++i;
    else
      ++j;
  }
}

void find_union(const DepthRanges& a, const DepthRanges& b, DepthRanges& either) {
  either.clear();
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    const bool takes_a = j == b.size() || (i < a.size() && a[i].begin <= b[j].begin);
    const DepthRange& next = takes_a ? a[i++] : b[j++];
    append_range(either, next.begin, either.empty() ? next.end : std::max(next.end, either.back().end));
  }
}

}  // namespace

ClipScene make_clip_scene(const Clipping& clipping, std::span<const PreparedGrid* const> volumes,
                          const std::array<double, 12>& world_from_camera) {
  TETRAVOX_CHECK_LE(clipping.shapes.size(), volumes.size());
  ClipScene scene;
  scene.use_union = clipping.use_union;
  for (std::size_t i = 0; i < clipping.shapes.size(); ++i) {
    const ClipShape& shape = clipping.shapes[i];
    if (const auto* volume = std::get_if<ClipVolume>(&shape.shape)) {
      TETRAVOX_CHECK_EQ(volumes[i] != nullptr, true);
      scene.shapes.push_back({place(*volumes[i], volume->value, world_from_camera), shape.keeps_inside});
    } else if (const auto* plane = std::get_if<ClipPlane>(&shape.shape)) {
      scene.shapes.push_back({place(*plane, world_from_camera), shape.keeps_inside});
    } else if (const auto* box = std::get_if<ClipBox>(&shape.shape)) {
      scene.shapes.push_back({place(*box, world_from_camera), shape.keeps_inside});
    } else {
      scene.shapes.push_back({place(std::get<ClipSphere>(shape.shape), world_from_camera), shape.keeps_inside});
    }
  }
  return scene;
}

void find_intervals(const ClipScene& scene, const ClipRay& ray, ClipScratch& scratch,
                    std::vector<ClipInterval>& intervals) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const DepthRange range{std::clamp(ray.z_begin, -kLargest, kLargest), std::clamp(ray.z_end, -kLargest, kLargest)};
  scratch.caches.resize(scene.shapes.size());
  scratch.kept.clear();
  if (scene.shapes.empty() || !scene.use_union) append_range(scratch.kept, range.begin, range.end);
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    if (!scene.use_union && scratch.kept.empty()) return;
    find_kept(scene.shapes[i], ray, range, scratch.caches[i], scratch);
    (scene.use_union ? find_union : find_intersection)(scratch.kept, scratch.shape, scratch.other);
    std::swap(scratch.kept, scratch.other);
  }
  // Ranges that floats cannot tell apart become one, or none.
  const std::size_t first = intervals.size();
  for (const DepthRange& kept : scratch.kept) {
    const ClipInterval interval{static_cast<float>(kept.begin), static_cast<float>(kept.end)};
    if (!(interval.z_near < interval.z_far)) continue;
    if (intervals.size() > first && intervals.back().z_far >= interval.z_near)
      intervals.back().z_far = interval.z_far;
    else
      intervals.push_back(interval);
  }
}

}  // namespace tetravox::cpu
