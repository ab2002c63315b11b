#include "src/cpu/shadows.h"

#include "src/support/memory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace tetravox::cpu {
namespace {

constexpr int kMostOpennessPoints = 64;    // along the longest side
constexpr double kWidestSingleView = 1.2;  // a near light in this many radii sees the body by six views

struct Sphere {
  Vector3 center{};
  double radius = 0.0;
};
Sphere sphere_around(const std::array<ValueRange, 3>& bounds) {
  Sphere sphere;
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    sphere.center[axis] = 0.5 * bounds[axis].min + 0.5 * bounds[axis].max;
    const double half = 0.5 * bounds[axis].max - 0.5 * bounds[axis].min;
    square += half * half;
  }
  sphere.radius = std::sqrt(square);
  return sphere;
}

/// A direction that is not parallel to `direction`, along an axis.
Vector3 pick_up(const Vector3& direction) {
  int least = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(direction[axis]) < std::abs(direction[least])) least = axis;
  Vector3 up{};
  up[least] = 1.0;
  return up;
}

std::array<Vector3, 8> corners_of(const std::array<ValueRange, 3>& bounds) {
  std::array<Vector3, 8> corners{};
  for (std::size_t i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) corners[i][axis] = i >> axis & 1 ? bounds[axis].max : bounds[axis].min;
  return corners;
}

/// Parallel light: a picture that the body fills.
Camera look_along(const Vector3& direction, const std::array<ValueRange, 3>& bounds) {
  const Sphere sphere = sphere_around(bounds);
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  Camera camera;
  for (int axis = 0; axis < 3; ++axis)
    camera.position[axis] = sphere.center[axis] - 2.0 * sphere.radius * direction[axis] / length;
  camera.focal_point = sphere.center;
  camera.view_up = pick_up(direction);
  camera.parallel_scale = sphere.radius;
  const scene::CameraFrame frame = scene::make_camera_frame(sphere.center, 1.0, camera, 2, 2);
  double half = 0.0;
  for (const Vector3& corner : corners_of(bounds))
    for (int side = 0; side < 2; ++side) {
      double offset = 0.0;
      for (int axis = 0; axis < 3; ++axis) offset += frame.axes[side][axis] * (corner[axis] - sphere.center[axis]);
      half = std::max(half, std::abs(offset));
    }
  camera.parallel_scale = half;
  return camera;
}

/// A near light: one view of the body, or six where it is too close.
std::vector<Camera> look_from(const Vector3& position, const std::array<ValueRange, 3>& bounds) {
  const Sphere sphere = sphere_around(bounds);
  const double distance =
      std::hypot(position[0] - sphere.center[0], position[1] - sphere.center[1], position[2] - sphere.center[2]);
  std::vector<Camera> cameras;
  Camera camera;
  camera.position = position;
  if (distance > kWidestSingleView * sphere.radius) {
    camera.focal_point = sphere.center;
    Vector3 view{};
    for (int axis = 0; axis < 3; ++axis) view[axis] = sphere.center[axis] - position[axis];
    camera.view_up = pick_up(view);
    camera.view_angle = 2.0 * std::asin(sphere.radius / distance) * 180.0 / std::numbers::pi;
    return {camera};
  }
  camera.view_angle = 90.0;
  for (int face = 0; face < 6; ++face) {
    Vector3 view{};
    view[face / 2] = face % 2 ? -1.0 : 1.0;
    for (int axis = 0; axis < 3; ++axis) camera.focal_point[axis] = position[axis] + view[axis] * sphere.radius;
    camera.view_up = pick_up(view);
    cameras.push_back(camera);
  }
  return cameras;
}

/// Rows of local coordinates of a camera's frame: what a world point is there.
Vector3 seen_from(const scene::CameraFrame& frame, const ShadowedBody& body, const Vector3& world) {
  Vector3 local{};
  for (int axis = 0; axis < 3; ++axis) local[axis] = (world[axis] - body.origin[axis]) / body.world_per_local;
  Vector3 seen{};
  for (int row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis) seen[row] += frame.axes[row][axis] * local[axis];
  return seen;
}

/// What is beyond the last step of a ray has the depth of that; before the first there is none.
void complete_depths(LightDepths& light) {
  const std::size_t pixels = static_cast<std::size_t>(light.size) * light.size;
  support::parallel_chunks(pixels, 1 << 10, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      float last = 0.0f;
      for (int slice = 0; slice < light.size; ++slice) {
        float& depth = light.depths[static_cast<std::size_t>(slice) * pixels + pixel];
        if (depth == depth)
          last = depth;
        else
          depth = last;
      }
    }
  });
}

LightDepths draw_light(const Camera& camera, int size, const RenderSettings& settings, const ShadowedBody& body,
                       const DrawDepths& draw) {
  LightDepths light;
  light.camera = camera;
  light.size = size;
  light.frame = scene::make_camera_frame(body.origin, body.world_per_local, camera, size, size);
  double near = std::numeric_limits<double>::infinity(), far = -near;
  for (const Vector3& corner : corners_of(body.bounds)) {
    const double z = seen_from(light.frame, body, corner)[2];
    near = std::min(near, z);
    far = std::max(far, z);
  }
  if (!light.frame.is_orthographic) near = std::max(near, light.frame.eye[2]);
  light.z_first = static_cast<float>(near);
  light.slices_per_z = static_cast<float>((size - 1) / std::max(far - near, 1e-12));
  const std::size_t count = static_cast<std::size_t>(size) * size * size;
  support::require_memory(count * sizeof(float), "the shadows of a light");
  light.depths.assign(count, std::numeric_limits<float>::quiet_NaN());

  LightPass pass{camera, settings, {light.depths.data(), size, size, size, light.z_first, light.slices_per_z}};
  pass.settings.width = pass.settings.height = size;
  pass.settings.lighting = {};
  pass.settings.lighting.gradient = settings.lighting.gradient;  // weights and functions may depend on it
  pass.settings.wants_depth = false;
  pass.settings.samples_per_voxel = 0.0;  // rays that go from cell to cell note depths on their way
  pass.settings.use_early_ray_termination = false;
  Image unseen{size, size, std::vector<float>(4 * static_cast<std::size_t>(size) * size)};
  draw(pass, unseen);
  complete_depths(light);
  return light;
}

/// Radical inverse of `index` in a prime base (Halton 1960).
double radical_inverse(std::uint64_t index, std::uint64_t base) {
  double inverse = 0.0, digit = 1.0 / static_cast<double>(base);
  for (; index > 0; index /= base, digit /= static_cast<double>(base))
    inverse += static_cast<double>(index % base) * digit;
  return inverse;
}

/// A number in [0, 1) that looks random for each seed (the finaliser of SplitMix64; Steele, Lea, Flood 2014).
double hash_unit(std::uint64_t seed) {
  seed += 0x9E3779B97F4A7C15u;
  seed = (seed ^ (seed >> 30)) * 0xBF58476D1CE4E5B9u;
  seed = (seed ^ (seed >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((seed ^ (seed >> 31)) >> 11) * 0x1p-53;
}

Vector3 direction_on_sphere(std::uint64_t index, std::uint64_t seed) {
  const auto turned = [&](double x, std::uint64_t salt) {
    const double y = x + hash_unit(2 * seed + salt);
    return y - std::floor(y);
  };
  const double z = 1.0 - 2.0 * turned(radical_inverse(index + 1, 2), 0);
  const double angle = 2.0 * std::numbers::pi * turned(radical_inverse(index + 1, 3), 1);
  const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// The depth at a world point, trilinear.
class DepthLookup {
 public:
  DepthLookup(const LightDepths& light, const ShadowedBody& body) : light_(light), body_(body) {}

  float operator()(const Vector3& world) const {
    const scene::CameraFrame& frame = light_.frame;
    const Vector3 seen = seen_from(frame, body_, world);
    const double half = 0.5 * light_.size - 0.5;
    const std::array<double, 3> at{(seen[0] - frame.eye[0]) / frame.pixel_step + half,
                                   (frame.eye[1] - seen[1]) / frame.pixel_step + half,
                                   (seen[2] - light_.z_first) * light_.slices_per_z};
    std::array<std::size_t, 3> node{};
    std::array<float, 3> t{};
    for (int axis = 0; axis < 3; ++axis) {
      const double inside = std::clamp(at[axis], 0.0, light_.size - 1.0);
      node[axis] = std::min(static_cast<std::size_t>(inside), static_cast<std::size_t>(light_.size) - 2);
      t[axis] = static_cast<float>(inside - static_cast<double>(node[axis]));
    }
    const auto row = static_cast<std::size_t>(light_.size), slice = row * row;
    const float* corner = light_.depths.data() + node[2] * slice + node[1] * row + node[0];
    const auto mix = [](float f, float a, float b) { return a + f * (b - a); };
    const auto edge = [&](std::size_t offset) { return mix(t[0], corner[offset], corner[offset + 1]); };
    return mix(t[2], mix(t[1], edge(0), edge(row)), mix(t[1], edge(slice), edge(slice + row)));
  }

 private:
  const LightDepths& light_;
  const ShadowedBody& body_;
};

/// Adds what comes through from one direction to each place.
void add_direction(const LightDepths& light, const ShadowedBody& body, const Vector3& towards, Openness& openness) {
  const DepthLookup depth_at(light, body);
  const auto& sizes = openness.sizes;
  support::parallel_chunks(static_cast<std::size_t>(sizes[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (int j = 0; j < sizes[1]; ++j)
        for (int i = 0; i < sizes[0]; ++i) {
          const std::array<double, 3> index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          Vector3 world{};
          for (int axis = 0; axis < 3; ++axis) {
            const ValueRange& bound = body.bounds[axis];
            world[axis] = bound.min + (bound.max - bound.min) * index[axis] / (sizes[axis] - 1);
          }
          const float through = std::exp(-depth_at(world));
          float* record = openness.records.data() + 4 * ((k * sizes[1] + j) * sizes[0] + i);
          for (int axis = 0; axis < 3; ++axis) record[axis] += through * static_cast<float>(towards[axis]);
          record[3] += through;
        }
  });
}

}  // namespace

std::vector<std::vector<LightDepths>> find_light_depths(const RenderSettings& settings, const ShadowedBody& body,
                                                        const Camera& eye, const DrawDepths& draw) {
  std::vector<std::vector<LightDepths>> found;
  for (const Light& light : settings.lighting.lights) {
    std::vector<Camera> cameras;
    if (light.kind == LightKind::kPoint) cameras = look_from(light.position, body.bounds);
    if (light.kind == LightKind::kDirectional) cameras = {look_along(light.direction, body.bounds)};
    if (light.kind == LightKind::kHeadlight && !eye.parallel_scale) cameras = look_from(eye.position, body.bounds);
    if (light.kind == LightKind::kHeadlight && eye.parallel_scale) {
      Vector3 view{};
      for (int axis = 0; axis < 3; ++axis) view[axis] = eye.focal_point[axis] - eye.position[axis];
      cameras = {look_along(view, body.bounds)};
    }
    std::vector<LightDepths>& views = found.emplace_back();
    for (const Camera& camera : cameras)
      views.push_back(draw_light(camera, settings.lighting.shadow_resolution, settings, body, draw));
  }
  return found;
}

ShadowMap make_shadow_map(const LightDepths& depths, const scene::CameraFrame& camera) {
  ShadowMap map;
  const scene::CameraFrame& light = depths.frame;
  map.is_perspective = !light.is_orthographic;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      double sum = 0.0;
      for (int i = 0; i < 3; ++i) sum += light.axes[row][i] * camera.axes[column][i];
      map.light_from_camera[4 * row + column] = static_cast<float>(sum);
    }
    map.light_from_camera[4 * row + 3] = static_cast<float>(-light.eye[row]);
  }
  const double half = 0.5 * depths.size - 0.5, step = light.pixel_step;
  map.scale[0] = static_cast<float>(1.0 / step);
  map.scale[1] = static_cast<float>(-1.0 / step);
  map.scale[2] = depths.slices_per_z;
  map.offset[0] = map.offset[1] = static_cast<float>(half);
  map.offset[2] = static_cast<float>((light.eye[2] - depths.z_first) * depths.slices_per_z);
  for (std::int32_t& size : map.sizes) size = depths.size;
  map.depths = depths.depths.data();
  return map;
}

Openness find_openness(const RenderSettings& settings, const ShadowedBody& body, const DrawDepths& draw,
                       const Progress& progress) {
  Openness openness;
  double longest = 0.0;
  for (const ValueRange& bound : body.bounds) longest = std::max(longest, bound.max - bound.min);
  const int most = std::min(kMostOpennessPoints, settings.lighting.shadow_resolution);
  for (int axis = 0; axis < 3; ++axis) {
    const double side = body.bounds[axis].max - body.bounds[axis].min;
    openness.sizes[axis] = std::max(2, static_cast<int>(std::lround(most * side / longest)));
  }
  openness.records.assign(4 * static_cast<std::size_t>(openness.sizes[0]) * openness.sizes[1] * openness.sizes[2],
                          0.0f);
  const int count = settings.lighting.ambient_occlusion;
  for (int i = 0; i < count; ++i) {
    support::throw_if_cancelled(progress);
    const Vector3 towards = direction_on_sphere(static_cast<std::uint64_t>(i), settings.lighting.occlusion_seed);
    const Camera camera = look_along({-towards[0], -towards[1], -towards[2]}, body.bounds);
    add_direction(draw_light(camera, most, settings, body, draw), body, towards, openness);
  }
  for (float& value : openness.records) value /= static_cast<float>(count);
  return openness;
}

OcclusionMap make_occlusion_map(const Openness& openness, const ShadowedBody& body, const scene::CameraFrame& camera) {
  OcclusionMap map;
  for (int row = 0; row < 3; ++row) {
    const ValueRange& bound = body.bounds[row];
    const double scale = (openness.sizes[row] - 1) / std::max(bound.max - bound.min, 1e-300);
    for (int column = 0; column < 3; ++column) {
      map.lattice_from_camera[4 * row + column] =
          static_cast<float>(camera.axes[column][row] * body.world_per_local * scale);
      map.world_from_camera[3 * row + column] = static_cast<float>(camera.axes[column][row]);
    }
    map.lattice_from_camera[4 * row + 3] = static_cast<float>((body.origin[row] - bound.min) * scale);
    map.sizes[row] = openness.sizes[row];
  }
  map.visibility = openness.records.data();
  return map;
}

float find_shadow_step(const RenderSettings& settings, const ShadowedBody& body) {
  const double diameter = 2.0 * sphere_around(body.bounds).radius / body.world_per_local;
  return static_cast<float>(diameter / settings.lighting.shadow_resolution);
}

}  // namespace tetravox::cpu
