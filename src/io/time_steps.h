#pragma once

#include "tetravox/scene.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tetravox::io {

/// Index into `times` (ascending) of the step that `request` asks for: its index, or the step nearest its value; the
/// first step when it asks for nothing. 0 for a file without time steps.
/// @throws Error (kInvalidArgument) that names `file` and the range when there is no such step.
std::size_t pick_time(const std::vector<double>& times, const TimeRequest& request, const std::string& file);

}  // namespace tetravox::io
