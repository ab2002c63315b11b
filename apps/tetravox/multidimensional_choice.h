#pragma once

/// Functions of several variables, and colours by another array: from the command line and the scene to the renderer.

#include "apps/tetravox/body.h"
#include "apps/tetravox/options.h"

#include "tetravox/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace tetravox::tool {

/// Puts the options over the scene, before data are read. @throws UsageError for what does not go together.
void override_multidimensional(const MultidimensionalOptions& options, const FunctionOptions& function, Scene& scene);

/// Options that change nothing where the volume is not drawn, one line each.
std::vector<std::string> check_multidimensional(const MultidimensionalOptions& options, bool shows_volume);

/// Completes the scene's function of several variables from the data, and makes its table; nothing where there is none.
/// @throws Error for a table that cannot be read.
std::optional<OpticalTable> choose_table(const MultidimensionalOptions& options, const FunctionOptions& function,
                                         const Body& body, Scene& scene);

/// Completes the colours that follow another array; nothing where they follow the value.
std::optional<OpticalFunction> choose_colors(const MultidimensionalOptions& options, const Body& body, Scene& scene);

}  // namespace tetravox::tool
