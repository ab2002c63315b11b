#pragma once

/// Options of functions of several variables, and of colours by another array.

#include "apps/tetravox/options.h"

namespace CLI {
class App;
}

namespace tetravox::tool {

/// Adds the options to the command; parsing fills `options`.
void add_multidimensional(CLI::App& app, MultidimensionalOptions& options);

}  // namespace tetravox::tool
