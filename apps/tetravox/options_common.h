#pragma once

/// Options of `tetravox render`, several of which other commands have too.

#include "apps/tetravox/options.h"

namespace CLI {
class App;
}

namespace tetravox::tool {

/// What to read, and which of its arrays and time steps.
void add_input(CLI::App& app, InputOptions& input);
/// How to understand the bytes of a RAW file.
void add_raw_layout(CLI::App& app, InputOptions& input);
void add_function(CLI::App& app, FunctionOptions& function);
void add_camera(CLI::App& app, CameraOptions& camera);
/// What is written, and how.
void add_picture(CLI::App& app, RenderOptions& options);
/// What draws.
void add_method(CLI::App& app, RenderOptions& options);

}  // namespace tetravox::tool
