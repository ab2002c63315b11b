#include "apps/tetravox/memory_plan.h"

#include "apps/tetravox/body.h"
#include "apps/tetravox/text.h"

#include "tetravox/error.h"
#include "tetravox/grid.h"
#include "tetravox/io.h"
#include "tetravox/mesh.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace tetravox::tool {

MemoryPlan plan_memory(const Dataset& dataset, const RenderSettings& settings) {
  MemoryPlan plan;
  const auto plan_preparing = [&plan](const MemoryEstimate& prepare, std::size_t fields) {
    plan.prepare = prepare.peak * fields;
    plan.resident = prepare.resident * fields;
  };
  if (dataset.is_grid()) {
    plan_preparing(estimate_prepare_memory(dataset.grid), 1 + dataset.other_grids.size());
    plan.values = value_bytes(dataset);
    plan.render = estimate_render_memory(dataset.grid, settings);
    // Further fields have copies of their own where the filter asks for them.
    RenderSettings unfiltered = settings;
    unfiltered.filter = {};
    for (const GridData& other : dataset.other_grids)
      plan.render += estimate_render_memory(other, settings) - estimate_render_memory(other, unfiltered);
  } else {
    const MeshData& mesh = dataset.mesh;
    plan_preparing(estimate_prepare_memory(mesh), 1);
    // A boundary of as many faces as there are cells is far beyond what meshes have.
    plan.render = estimate_render_memory(mesh.point_count(), mesh.cell_count(), settings);
  }
  RenderSettings without_tables = settings;
  without_tables.integrator = Integrator::kAntiderivative;
  plan.tables = estimate_render_memory(0, 0, settings) - estimate_render_memory(0, 0, without_tables);
  plan.available = available_memory();
  plan.width = settings.width;
  plan.height = settings.height;
  return plan;
}

void require_memory(const MemoryPlan& plan, const std::string& data_path) {
  const std::uint64_t needed = std::max(plan.prepare, plan.resident + plan.render);
  if (needed <= plan.available) return;
  const bool is_picture = plan.resident + plan.render > plan.prepare && plan.render > plan.resident;
  const std::string advice = plan.tables > needed / 2 ? "give a smaller --preintegration-size"
                             : is_picture             ? "give a smaller --resolution"
                                                      : "close other programs";
  throw Error(ErrorCode::kOutOfMemory, "drawing '" + data_path + "' at " + std::to_string(plan.width) + " x " +
                                           std::to_string(plan.height) + " needs about " + format_bytes(needed) +
                                           " of memory and " + format_bytes(plan.available) + " are free: " + advice +
                                           " or use a larger machine");
}

}  // namespace tetravox::tool
