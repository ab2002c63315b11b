#include "src/cpu/clip_intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::cpu {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// World place of depth z: origin + z * direction.
struct WorldRay {
  Vector3 origin{}, direction{};
};

WorldRay make_world_ray(const ClipScene& scene, const ClipRay& ray) {
  WorldRay world;
  for (int row = 0; row < 3; ++row) {
    const double* m = scene.world_from_camera.data() + 4 * row;
    world.origin[row] = m[0] * ray.x_offset + m[1] * ray.y_offset + m[3];
    world.direction[row] = m[0] * ray.x_slope + m[1] * ray.y_slope + m[2];
  }
  return world;
}

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

void find_inside(const ClipPlane& plane, const WorldRay& ray, std::vector<DepthRange>& inside) {
  const double distance = dot(plane.normal, difference(ray.origin, plane.origin));
  const double rate = dot(plane.normal, ray.direction);
  if (rate == 0.0) {
    if (distance >= 0.0) inside.push_back({-kInfinity, kInfinity});
    return;
  }
  const double z = -distance / rate;
  inside.push_back(rate > 0.0 ? DepthRange{z, kInfinity} : DepthRange{-kInfinity, z});
}

void find_inside(const ClipBox& box, const WorldRay& ray, std::vector<DepthRange>& inside) {
  DepthRange range{-kInfinity, kInfinity};
  for (int axis = 0; axis < 3; ++axis) {
    const double origin = ray.origin[axis], direction = ray.direction[axis];
    const ValueRange& bounds = box.bounds[axis];
    if (direction == 0.0) {
      if (origin < bounds.min || origin > bounds.max) return;
      continue;
    }
    const double a = (bounds.min - origin) / direction, b = (bounds.max - origin) / direction;
    range.first = std::max(range.first, std::min(a, b));
    range.second = std::min(range.second, std::max(a, b));
  }
  if (range.first < range.second) inside.push_back(range);
}

/// By the place nearest to the centre, so that little cancels.
void find_inside(const ClipSphere& sphere, const WorldRay& ray, std::vector<DepthRange>& inside) {
  const double square = dot(ray.direction, ray.direction);
  const double nearest = dot(ray.direction, difference(sphere.center, ray.origin)) / square;
  Vector3 offset = difference(ray.origin, sphere.center);
  for (int axis = 0; axis < 3; ++axis) offset[axis] += nearest * ray.direction[axis];
  const double rest = sphere.radius * sphere.radius - dot(offset, offset);
  if (!(rest > 0.0)) return;
  const double half = std::sqrt(rest / square);
  inside.push_back({nearest - half, nearest + half});
}

void find_inside(const ClipField& field, const WorldRay& ray, std::vector<DepthRange>& inside) {
  GridLine line;
  const grid::GridFrame& frame = field.frame();
  const Vector3 offset = difference(ray.origin, {frame.origin[0], frame.origin[1], frame.origin[2]});
  for (int row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis) {
      line.origin[row] += frame.grid_from_world[3 * row + axis] * offset[axis];
      line.direction[row] += frame.grid_from_world[3 * row + axis] * ray.direction[axis];
    }
  field.find_inside(line, inside);
}

void find_inside(const ClipScene::Shape& shape, const WorldRay& ray, std::vector<DepthRange>& inside) {
  if (shape.field) return find_inside(*shape.field, ray, inside);
  if (const auto* plane = std::get_if<ClipPlane>(&shape.shape.shape)) find_inside(*plane, ray, inside);
  if (const auto* box = std::get_if<ClipBox>(&shape.shape.shape)) find_inside(*box, ray, inside);
  if (const auto* sphere = std::get_if<ClipSphere>(&shape.shape.shape)) find_inside(*sphere, ray, inside);
}

/// What lies between and beyond ascending ranges.
void complement(std::vector<DepthRange>& ranges) {
  std::vector<DepthRange> rest;
  double begin = -kInfinity;
  for (const DepthRange& range : ranges) {
    if (range.first > begin) rest.push_back({begin, range.first});
    begin = range.second;
  }
  if (begin < kInfinity) rest.push_back({begin, kInfinity});
  ranges.swap(rest);
}

/// Where at least `wanted` of some lists of ascending ranges overlap: a sweep over their ends.
std::vector<DepthRange> find_overlaps(const std::vector<std::vector<DepthRange>>& lists, int wanted) {
  std::vector<std::pair<double, int>> ends;  // a beginning before an end at the same depth
  for (const auto& list : lists)
    for (const DepthRange& range : list) {
      ends.push_back({range.first, -1});
      ends.push_back({range.second, +1});
    }
  std::sort(ends.begin(), ends.end());
  std::vector<DepthRange> overlaps;
  int depth = 0;
  double begin = 0.0;
  for (const auto& [z, step] : ends) {
    const bool was_inside = depth >= wanted;
    depth -= step;
    const bool is_inside = depth >= wanted;
    if (!was_inside && is_inside) begin = z;
    if (was_inside && !is_inside && z > begin) overlaps.push_back({begin, z});
  }
  return overlaps;
}

}  // namespace

ClipScene make_clip_scene(const Clipping& clipping, std::span<const PreparedGrid* const> volumes,
                          const std::array<double, 12>& world_from_camera) {
  ClipScene scene;
  scene.use_union = clipping.use_union;
  scene.world_from_camera = world_from_camera;
  for (std::size_t i = 0; i < clipping.shapes.size(); ++i) {
    ClipScene::Shape& shape = scene.shapes.emplace_back(ClipScene::Shape{clipping.shapes[i], nullptr});
    if (const auto* volume = std::get_if<ClipVolume>(&shape.shape.shape))
      shape.field = std::make_shared<ClipField>(*volumes[i], volume->value);
  }
  return scene;
}

void find_intervals(const ClipScene& scene, const ClipRay& ray, std::vector<ClipInterval>& intervals) {
  const WorldRay world = make_world_ray(scene, ray);
  std::vector<std::vector<DepthRange>> inside(scene.shapes.size());
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    find_inside(scene.shapes[i], world, inside[i]);
    if (!scene.shapes[i].shape.keeps_inside) complement(inside[i]);
  }
  const bool is_single = inside.size() == 1;
  const int wanted = scene.use_union ? 1 : static_cast<int>(inside.size());
  for (const DepthRange& range : is_single ? inside.front() : find_overlaps(inside, wanted)) {
    const auto near = static_cast<float>(std::max(range.first, ray.z_begin));
    const auto far = static_cast<float>(std::min(range.second, ray.z_end));
    if (near < far) intervals.push_back({near, far});
  }
}

}  // namespace tetravox::cpu
