#include "apps/tetravox/memory_plan.h"

#include "apps/tetravox/text.h"

#include "tetravox/error.h"
#include "tetravox/io.h"

#include <algorithm>

namespace tetravox::tool {

MemoryPlan plan_memory(const MeshData& mesh, const RenderSettings& settings) {
  const MemoryEstimate prepare = estimate_prepare_memory(mesh);
  MemoryPlan plan;
  plan.prepare = prepare.peak;
  plan.resident = prepare.resident;
  // A boundary of as many faces as there are cells is far beyond what meshes have.
  plan.render = estimate_render_memory(mesh.point_count(), mesh.cell_count(), settings);
  plan.available = available_memory();
  plan.width = settings.width;
  plan.height = settings.height;
  return plan;
}

void require_memory(const MemoryPlan& plan, const std::string& data_path) {
  const std::uint64_t needed = std::max(plan.prepare, plan.resident + plan.render);
  if (needed <= plan.available) return;
  const bool is_picture = plan.resident + plan.render > plan.prepare && plan.render > plan.resident;
  throw Error(ErrorCode::kOutOfMemory,
              "drawing '" + data_path + "' at " + std::to_string(plan.width) + " x " + std::to_string(plan.height) +
                  " needs about " + format_bytes(needed) + " of memory and " + format_bytes(plan.available) +
                  " are free: " + (is_picture ? "give a smaller --resolution" : "close other programs") +
                  " or use a larger machine");
}

std::uint64_t input_bytes(const MeshData& mesh) {
  return mesh.points.size_bytes() + mesh.cell_types.size_bytes() + mesh.cell_offsets.size_bytes() +
         mesh.connectivity.size_bytes() + mesh.scalars.size_bytes();
}

std::uint64_t prepared_bytes(const PreparedMesh& mesh) {
  return mesh.vertices.size() * sizeof(Vertex) + mesh.cells.size() * sizeof(TetrahedronLinks) +
         mesh.cell_scalars.size() * sizeof(float) + mesh.boundary.size() * sizeof(BoundaryFace);
}

}  // namespace tetravox::tool
