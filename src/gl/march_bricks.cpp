#include "src/gl/march_bricks.h"

#include <array>
#include <bit>
#include <cstddef>

namespace tetravox::gl {

std::uint32_t pack_plan(const scene::BrickPlan& plan, bool has_missing) {
  return plan.level | static_cast<std::uint32_t>(plan.stride) << 8 | static_cast<std::uint32_t>(plan.is_curved) << 16 |
         static_cast<std::uint32_t>(plan.is_gentle) << 17 | static_cast<std::uint32_t>(has_missing) << 18;
}

void MarchBricks::upload(const scene::PlanSources& sources, const std::vector<scene::BrickPlan>& plans,
                         const grid::GridFrame& frame) {
  const BrickSummaries& bricks = sources.grid->bricks;
  std::vector<std::array<std::uint32_t, 4>> records(plans.size());
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const ValueRange range = scene::range_of(sources, i);
    const float steepness = plans[i].is_curved ? sources.steepness->largest_steepness(static_cast<float>(range.min),
                                                                                      static_cast<float>(range.max))
                                               : 0.0f;
    records[i] = {pack_plan(plans[i], bricks.has_missing[i] != 0), std::bit_cast<std::uint32_t>(steepness), 0, 1};
  }
  plans_.upload(GL_RGBA32UI, records.data(), records.size() * sizeof(records[0]));
  steepness_.upload(GL_R32F, sources.steepness->steepness.data(), sources.steepness->steepness.size() * sizeof(float));
  std::vector<float> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t i = 0; i < sources.grid->data.shape.dimensions[axis]; ++i)
      planes.push_back(frame.plane(axis, i));
  planes_.upload(GL_R32F, planes.data(), planes.size() * sizeof(float));
}

void MarchBricks::bind() const {
  plans_.bind(kBrickUnit);
  planes_.bind(kPlaneUnit);
  steepness_.bind(kSteepnessUnit);
}

}  // namespace tetravox::gl
