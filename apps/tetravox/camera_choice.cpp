#include "apps/tetravox/camera_choice.h"

namespace tetravox::tool {

Camera override_camera(const CameraOptions& options, Camera camera) {
  camera.position = options.position.value_or(camera.position);
  camera.focal_point = options.focal_point.value_or(camera.focal_point);
  camera.view_up = options.view_up.value_or(camera.view_up);
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
