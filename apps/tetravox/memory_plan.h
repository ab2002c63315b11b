#pragma once

/// Will it fit? Asked before anything large is allocated.

#include "apps/tetravox/json_report.h"

#include "tetravox/dataset.h"
#include "tetravox/render.h"

#include <string>

namespace tetravox::tool {

/// Upper estimates for preparing and drawing what was read already.
MemoryPlan plan_memory(const Dataset& dataset, const RenderSettings& settings);

/// @throws Error (kOutOfMemory) in one line where the plan exceeds what is there.
void require_memory(const MemoryPlan& plan, const std::string& data_path);

}  // namespace tetravox::tool
