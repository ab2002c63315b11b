#pragma once

/// Will it fit? Asked before anything large is allocated.

#include "apps/tetravox/json_report.h"

#include "tetravox/mesh.h"
#include "tetravox/render.h"

#include <string>

namespace tetravox::tool {

/// Upper estimates for preparing and drawing `mesh`, which was read already.
MemoryPlan plan_memory(const MeshData& mesh, const RenderSettings& settings);

/// @throws Error (kOutOfMemory) in one line where the plan exceeds what is there.
void require_memory(const MemoryPlan& plan, const std::string& data_path);

/// Bytes that a mesh holds.
std::uint64_t input_bytes(const MeshData& mesh);
std::uint64_t prepared_bytes(const PreparedMesh& mesh);

}  // namespace tetravox::tool
