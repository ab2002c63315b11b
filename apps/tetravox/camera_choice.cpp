#include "apps/tetravox/camera_choice.h"

#include <cstddef>

namespace tetravox::tool {

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
