#pragma once

/// The camera that the command line asks for.

#include "apps/tetravox/body.h"
#include "apps/tetravox/options.h"

#include "tetravox/camera.h"
#include "tetravox/scene.h"

#include <optional>

namespace tetravox::tool {

/// `camera` with what the options give in its place, then turned and zoomed. Where it looks along what is up and no
/// option says what else is, y is. `middle`: of the data, which a position alone looks at; none where the camera is
/// that of a scene. @throws Error (kInvalidArgument).
Camera override_camera(const CameraOptions& options, Camera camera, const std::optional<Vector3>& middle);

/// The middle of the data, for `override_camera`.
std::optional<Vector3> find_middle(const Scene& scene, const Body& body);

}  // namespace tetravox::tool
