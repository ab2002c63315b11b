#include "apps/tetravox/camera_choice.h"

#include <cstddef>

namespace tetravox::tool {
namespace {

/// Whether the line of sight is that of `view_up`, near enough for `validate_camera` to refuse it.
bool looks_along_up(const Camera& camera) {
  const Vector3& up = camera.view_up;
  Vector3 forward{};
  for (std::size_t i = 0; i < 3; ++i) forward[i] = camera.focal_point[i] - camera.position[i];
  double across = 0.0, forward_square = 0.0, up_square = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double component = forward[j] * up[k] - forward[k] * up[j];
    across += component * component;
    forward_square += forward[i] * forward[i];
    up_square += up[i] * up[i];
  }
  return across <= 1e-17 * forward_square * up_square;
}

}  // namespace

std::optional<Vector3> find_middle(const Scene& scene, const Body& body) {
  if (scene.camera) return {};
  const auto bounds = bounds_of(body);
  Vector3 middle{};
  for (std::size_t i = 0; i < 3; ++i) middle[i] = 0.5 * bounds[i].min + 0.5 * bounds[i].max;
  return middle;
}

Camera override_camera(const CameraOptions& options, Camera camera, const std::optional<Vector3>& middle) {
  if (options.position && middle) camera.focal_point = *middle;
  camera.position = options.position.value_or(camera.position);
  camera.focal_point = options.focal_point.value_or(camera.focal_point);
  camera.view_up = options.view_up.value_or(camera.view_up);
  // Who looks straight down and says no more sees what a map shows: y up.
  if (!options.view_up && looks_along_up(camera)) {
    camera.view_up = {0, 1, 0};
    if (looks_along_up(camera)) camera.view_up = {0, 0, 1};
  }
  if (options.view_angle) {
    camera.view_angle = *options.view_angle;
    camera.parallel_scale.reset();
  }
  if (options.parallel_scale) camera.parallel_scale = options.parallel_scale;
  validate_camera(camera);
  if (options.azimuth != 0.0 || options.elevation != 0.0)
    camera = rotate_camera(camera, options.azimuth, options.elevation);
  if (options.zoom != 1.0) camera = zoom_camera(camera, options.zoom);
  validate_camera(camera);
  return camera;
}

}  // namespace tetravox::tool
