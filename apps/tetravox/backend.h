#pragma once

/// What draws: the CPU, or OpenGL where this build has it.

#include "apps/tetravox/body.h"
#include "apps/tetravox/options.h"

#include "tetravox/render.h"
#include "tetravox/scene.h"

#include <string>
#include <utility>
#include <vector>

namespace tetravox::tool {

/// A renderer of the backend that `draws_by_gl` names. @throws Error, also where this build has none of OpenGL.
Renderer make_renderer(const Body& body, const MethodOptions& method, const Scene& scene);

/// Backends with their sources, and the integrators of each.
std::vector<std::pair<std::string, std::string>> method_rows();

/// Devices for OpenGL, by number: what they call themselves, and their version.
std::vector<std::pair<std::string, std::string>> device_names();

/// "AVX2, 4 threads", or the device.
std::string describe_backend(const RenderStatistics& drawn);

}  // namespace tetravox::tool
