#include "src/gl/march_bricks.h"

#include "src/scene/fixed_rate.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace tetravox::gl {

std::uint32_t pack_plan(scene::BrickPlan plan, bool has_missing) {
  if (plan.stride > 0) {
    plan.stride = static_cast<std::uint8_t>(plan.stride << plan.level);
    plan.level = 0;
  }
  return plan.level | static_cast<std::uint32_t>(plan.stride) << 8 | static_cast<std::uint32_t>(plan.is_curved) << 16 |
         static_cast<std::uint32_t>(plan.is_gentle) << 17 | static_cast<std::uint32_t>(has_missing) << 18;
}

RaySteps find_ray_steps(const scene::PlanSources& sources, const std::vector<scene::BrickPlan>& plans,
                        const StepLengths& lengths, const IntegratorTables& tables) {
  RaySteps steps;
  steps.segments.is_gentle = true;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const scene::BrickPlan& plan = plans[i];
    if (plan.level == scene::BrickPlan::kTransparent) continue;
    (plan.stride > 0 ? steps.has_strides : steps.has_cells) = true;
    steps.segments.is_gentle &= plan.is_gentle;
    const ValueRange range = scene::range_of(sources, i);
    const auto min = static_cast<float>(range.min), max = static_cast<float>(range.max);
    const int cells = std::max(1, int{plan.stride}) << plan.level;
    const double length = plan.stride > 0 && lengths.sampled > 0.0 ? lengths.sampled : cells * lengths.cell;
    const double depth = length * static_cast<double>(sources.steepness->largest_extinction(min, max));
    steps.segments.depth = std::max(steps.segments.depth, depth);
    steps.segments.error = std::max(steps.segments.error, depth * depth * tables.color_change(min, max));
  }
  // Steps that are counted on may lead from one brick through the next.
  if (lengths.sampled > 0.0) {
    const ValueRange all = scene::stored_range(*sources.grid);
    const double change = tables.color_change(static_cast<float>(all.min), static_cast<float>(all.max));
    steps.segments.error = steps.segments.depth * steps.segments.depth * change;
  }
  return steps;
}

void MarchBricks::upload(const scene::PlanSources& sources, const std::vector<scene::BrickPlan>& plans,
                         const grid::GridFrame& frame) {
  const BrickSummaries& bricks = sources.grid->bricks;
  const std::vector<std::uint8_t> spans = scene::list_seen_spans(bricks.counts, plans);
  records_.resize(plans.size());
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const ValueRange range = scene::range_of(sources, i);
    const float steepness = plans[i].is_curved ? sources.steepness->largest_steepness(static_cast<float>(range.min),
                                                                                      static_cast<float>(range.max))
                                               : 0.0f;
    const std::uint32_t plan = pack_plan(plans[i], bricks.has_missing[i] != 0) | std::uint32_t{spans[i]} << 24;
    records_[i] = {plan, std::bit_cast<std::uint32_t>(steepness), 0, 1};
  }
  plans_.upload(GL_RGBA32UI, records_.data(), records_.size() * sizeof(records_[0]));
  steepness_.upload(GL_R32F, sources.steepness->steepness.data(), sources.steepness->steepness.size() * sizeof(float));
  std::vector<float> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t i = 0; i < sources.grid->data.shape.dimensions[axis]; ++i)
      planes.push_back(frame.plane(axis, i));
  planes_.upload(GL_R32F, planes.data(), planes.size() * sizeof(float));
}

void MarchBricks::place_nodes(const std::vector<NodePlace>& places) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    records_[i][2] = places[i].first;
    records_[i][3] = places[i].parts;
  }
  plans_.upload(GL_RGBA32UI, records_.data(), records_.size() * sizeof(records_[0]));
}

void MarchBricks::bind() const {
  plans_.bind(kBrickUnit);
  planes_.bind(kPlaneUnit);
  steepness_.bind(kSteepnessUnit);
}

}  // namespace tetravox::gl
