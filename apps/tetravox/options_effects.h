#pragma once

/// Options of light, surfaces, clipping and functions of several variables.

#include "apps/tetravox/options.h"

namespace CLI {
class App;
}

namespace tetravox::tool {

void add_light(CLI::App& app, EffectOptions& effects);
/// Surfaces, clipping, and what else decides where there is something.
void add_shapes(CLI::App& app, EffectOptions& effects);

}  // namespace tetravox::tool
