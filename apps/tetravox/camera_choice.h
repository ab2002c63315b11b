#pragma once

/// The camera that the command line asks for.

#include "apps/tetravox/options.h"

#include "tetravox/camera.h"

namespace tetravox::tool {

/// `camera` with what the options give in its place, then turned and zoomed. Where it looks along what is up and no
/// option says what else is, y is. @throws Error (kInvalidArgument).
Camera override_camera(const CameraOptions& options, Camera camera);

}  // namespace tetravox::tool
