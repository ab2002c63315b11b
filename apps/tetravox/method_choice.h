#pragma once

/// How segments are found and drawn: what the command line asks for, put over the scene, and whether it suits the data.

#include "apps/tetravox/options.h"

#include "tetravox/dataset.h"
#include "tetravox/render.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::tool {

/// Names of classifications with one-line descriptions.
std::vector<std::pair<std::string, std::string>> classification_names();

/// "preintegrated", "post", "pre" as an index into the enumerator. @throws UsageError that names the option.
Classification parse_classification(const std::string& option, const std::string& text);

/// @throws UsageError where --classification and --integrator contradict each other.
void require_consistent(const MethodOptions& method);

/// Puts the options over the scene's settings. "preintegrated" keeps a pre-integrating integrator of the scene.
void override_method(const MethodOptions& method, RenderSettings& settings);

/// Whether OpenGL draws: where that is asked for, or where nothing is and only OpenGL has the source or what makes the
/// tables. `association`: of the array that is drawn; constant cells need no tables.
bool draws_by_gl(const MethodOptions& method, const RenderSettings& settings, std::optional<Association> association);

/// Options that change nothing here, one line each. `data_name` is for messages.
/// @throws UsageError (an option) or Error (the scene) for what is not for this kind of data: the picture would not be
/// what was asked.
std::vector<std::string> check_method(const MethodOptions& method, const RenderSettings& settings,
                                      const Dataset& dataset, const std::string& data_name);

}  // namespace tetravox::tool
