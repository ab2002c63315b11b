#pragma once

/// VTK's camera: position, focal point, view up, vertical view angle or parallel scale.

#include "tetravox/dataset.h"

#include <array>
#include <optional>

namespace tetravox {

using Vector3 = std::array<double, 3>;

struct Camera {
  Vector3 position{0, 0, 1};
  Vector3 focal_point{0, 0, 0};
  Vector3 view_up{0, 1, 0};
  double view_angle = 30.0;              ///< vertical, degrees, in (0, 180); ignored with a parallel scale
  std::optional<double> parallel_scale;  ///< orthographic: half the height of the picture, world units
};

/// Whether the line of sight is that of `view_up`, so that nothing is up in the picture.
bool looks_along_up(const Camera& camera);

/// @throws Error (kInvalidArgument) where the camera defines no view: names the member.
void validate_camera(const Camera& camera);

/// An oblique perspective view in which all of `bounds` is visible and large at this aspect (width / height), z up.
Camera make_default_camera(const std::array<ValueRange, 3>& bounds, double aspect);

/// The camera turned about the focal point: `azimuth` about view_up, `elevation` about the camera's right; degrees, as
/// VTK.
Camera rotate_camera(const Camera& camera, double azimuth, double elevation);

/// The camera with its view angle (or parallel scale) divided by `factor` > 0, as VTK's Zoom.
Camera zoom_camera(const Camera& camera, double factor);

}  // namespace tetravox
