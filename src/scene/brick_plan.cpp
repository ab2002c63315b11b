#include "src/scene/brick_plan.h"

#include "src/scene/fixed_rate.h"
#include "src/scene/preintegration_cache.h"
#include "src/support/threads.h"

#include <algorithm>

namespace tetravox::scene {
namespace {

/// Errors of scalars that lie within their bounds hardly ever add up along a whole ray: a ray may be that many times
/// worse than asked if they all did. Measured: the worst pixel errs by about half of what the tolerance says.
constexpr double kRatePerTolerance = 10.0;

/// The bound on the distance from a chord holds for the worst place of a brick, and for steps of that many times the
/// length that are met at the worst angle.
constexpr float kStridesPerRate = 2.0f;

/// By how many nodes a scalar that is rounded to one counts as being off: a quarter on average, to either side.
constexpr float kRounding = 0.25f;

/// At a fixed rate of one sample a voxel pictures err by more than that many times the default tolerance anyway, and
/// less with the square of the rate.
constexpr double kRoundingAtRate = 20.0;

/// Extinctions that let all but this part of the tolerance through along the longest ray are none.
constexpr double kHazeOfTolerance = 0.1;

/// Linear pieces that a cell is cut into at most. Where a ray only touches the height at which the function has a
/// narrow peak, a cubic needs many: twelve leave up to 2e-2 in single pixels of a function of nothing but narrow peaks,
/// and 1e-4 elsewhere. Below `kFineTolerance` there are as many as it takes.
constexpr float kMostPieces = 12.0f, kMostFinePieces = 256.0f;
constexpr double kFineTolerance = 1e-4;

/// Cells a step at most where light is to follow the gradient.
constexpr int kLongestLitStride = 2;

/// The longest step, or the largest lattice cells, of which the field stays as near to its chords as `is_good` asks.
template <class IsGood>
void choose_step(const BrickSummaries& bricks, std::size_t brick, const IsGood& is_good, BrickPlan& plan) {
  // A step of 2^level cells strays as far as a cell with such sides at most; one of a single cell half as far.
  for (int level = 3; level >= 0; --level) {
    const float deviation = level > 0 ? bricks.deviation[level][brick] : 0.5f * bricks.deviation[1][brick];
    if (!is_good(deviation)) continue;
    plan.level = static_cast<std::uint8_t>(std::max(level - 1, 0));
    plan.stride = static_cast<std::uint8_t>(1 << (level - plan.level));
    plan.is_curved = false;
    return;
  }
}

/// Calls `visit(brick)` for the bricks of a group.
template <class Visit>
void for_each_brick(const PlanSources& sources, std::size_t group, const Visit& visit) {
  const auto& counts = sources.grid->bricks.counts;
  const BrickSpan span = bricks_of_group(*sources.grid, *sources.groups, group);
  for (std::uint32_t k = span.first[2]; k < span.end[2]; ++k)
    for (std::uint32_t j = span.first[1]; j < span.end[1]; ++j)
      for (std::uint32_t i = span.first[0]; i < span.end[0]; ++i)
        visit((static_cast<std::size_t>(k) * counts[1] + j) * counts[0] + i);
}

class Planner {
 public:
  Planner(const PlanSources& sources, const PlanSettings& settings)
      : sources_(sources),
        settings_(settings),
        allowed_rate_(allowed_rate_of(settings.tolerance, sources.diagonal)),
        allowed_haze_(allowed_haze_of(settings.tolerance, sources.diagonal)),
        has_rate_(settings.samples_per_voxel > 0.0 && !sources.is_constant) {
    const PreparedGrid& grid = *sources.grid;
    is_even_ = has_even_axes(grid);
    strides_at_rate_ = has_rate_ && restarts_rate(grid, settings.integrator);
  }

  BrickPlan plan(std::size_t brick) const {
    const ValueRange range = range_of(sources_, brick);
    const auto min = static_cast<float>(range.min), max = static_cast<float>(range.max);
    BrickPlan plan;
    if (!(min <= max)) return plan;
    const bool absorbs = sources_.is_seen ? sources_.is_seen(brick, range) : is_absorbing(min, max);
    if (!counts_samples() && !absorbs && !has_surface(min, max)) return plan;
    plan.level = 0;
    if (sources_.is_by_cells) {
      plan.is_curved = true;
      return plan;
    }
    if (sources_.is_constant || counts_samples() || settings_.integrator == Integrator::kPre) return plan;

    const float steepness = sources_.steepness->largest_steepness(min, max);
    const auto is_good = [&](float deviation, float times = 1.0f) {
      return steepness == 0.0f || deviation * steepness <= times * allowed_rate_;
    };
    if (strides_at_rate_) {
      plan.stride = 1;
      const double rate = settings_.samples_per_voxel;
      plan.is_gentle = is_good(kRounding * sources_.node_width, static_cast<float>(kRoundingAtRate / (rate * rate)));
      return plan;
    }
    plan.is_gentle = is_good(kRounding * sources_.node_width);
    if (sources_.field->kernel) {
      plan.is_curved = steepness > 0.0f;
      return plan;
    }
    const BrickSummaries& bricks = sources_.grid->bricks;
    plan.is_curved = !is_good(bricks.deviation[0][brick]);
    if (!is_even_ || bricks.has_missing[brick] != 0 || has_surface(min, max)) return plan;
    // Tables of ray integrals reach as far as a cell does.
    if (scene::is_of_tables(settings_.integrator)) return plan;
    if (settings_.integrator != Integrator::kPost)
      choose_step(
          bricks, brick, [&](float deviation) { return is_good(deviation, kStridesPerRate); }, plan);
    if (settings_.wants_gradients && plan.stride > 0) {
      plan.stride = static_cast<std::uint8_t>(std::min(plan.stride << plan.level, kLongestLitStride));
      plan.level = 0;
    } else if (min == max && !settings_.wants_gradients)
      plan.level = 3;  // otherwise samples are counted in each cell
    return plan;
  }

  BrickPlan plan_group(std::size_t group) const {
    const BrickGroups& groups = *sources_.groups;
    const float min = groups.min[group], max = groups.max[group];
    BrickPlan plan;
    if (!(min <= max)) return plan;
    const bool may_be_seen = sources_.is_seen || counts_samples() || is_absorbing(min, max) || has_surface(min, max);
    if (!may_be_seen) return plan;
    plan.level = 0;
    const bool is_preintegrated =
        settings_.integrator == Integrator::kAntiderivative || settings_.integrator == Integrator::kPartial;
    const bool may_be_merged = is_preintegrated && is_even_ && !has_rate_ && !settings_.wants_gradients &&
                               !sources_.is_constant && !sources_.is_by_cells && !sources_.field->kernel;
    if (!may_be_merged || groups.has_missing[group] != 0 || has_surface(min, max)) return plan;
    const float steepness = sources_.steepness->largest_steepness(min, max);
    const auto is_good = [&](float deviation) { return steepness == 0.0f || deviation * steepness <= allowed_rate_; };
    // The field is no farther from any chord between two of its values than these are apart.
    if (!is_good(max - min)) return plan;
    plan.level = BrickPlan::kWholeGroup;
    plan.stride = 1;
    plan.is_gentle = is_good(kRounding * sources_.node_width);
    return plan;
  }

 private:
  /// Whether samples are counted on from the eye: these go through everything.
  bool counts_samples() const { return has_rate_ && !strides_at_rate_; }
  bool is_absorbing(float min, float max) const {
    return sources_.steepness->largest_extinction(min, max) > allowed_haze_;
  }
  bool has_surface(float min, float max) const {
    const auto& values = settings_.surface_values;
    const auto first = std::lower_bound(values.begin(), values.end(), min);
    return first != values.end() && *first <= max;
  }

  const PlanSources& sources_;
  const PlanSettings& settings_;
  float allowed_rate_, allowed_haze_;
  bool has_rate_, is_even_ = true;
  bool strides_at_rate_ = false;  ///< a fixed rate that may start anew in each brick
};

}  // namespace

bool has_even_axes(const PreparedGrid& grid) {
  const auto& axes = grid.data.shape.coordinates;
  return std::all_of(axes.begin(), axes.end(), [](const std::vector<double>& axis) { return axis.empty(); });
}

float allowed_rate_of(double tolerance, double diagonal) {
  return static_cast<float>(kRatePerTolerance * tolerance / diagonal);
}

float most_pieces_of(double tolerance) { return tolerance < kFineTolerance ? kMostFinePieces : kMostPieces; }

float allowed_haze_of(double tolerance, double diagonal) {
  return static_cast<float>(kHazeOfTolerance * tolerance / diagonal);
}

ValueRange range_of(const PlanSources& sources, std::size_t brick) {
  if (sources.field->kernel) return {sources.field->min[brick], sources.field->max[brick]};
  return {sources.grid->bricks.min[brick], sources.grid->bricks.max[brick]};
}

std::vector<BrickPlan> plan_groups(const PlanSources& sources, const PlanSettings& settings) {
  const Planner planner(sources, settings);
  std::vector<BrickPlan> plans(sources.groups->count());
  for (std::size_t i = 0; i < plans.size(); ++i) plans[i] = planner.plan_group(i);
  return plans;
}

std::vector<BrickPlan> plan_bricks(const PlanSources& sources, const PlanSettings& settings,
                                   std::span<const BrickPlan> of_groups) {
  const Planner planner(sources, settings);
  std::vector<BrickPlan> plans(sources.grid->bricks.count());
  if (of_groups.empty()) {
    support::parallel_chunks(plans.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) plans[i] = planner.plan(i);
    });
    return plans;
  }
  support::parallel_chunks(of_groups.size(), 1 << 6, [&](std::size_t begin, std::size_t end) {
    for (std::size_t group = begin; group < end; ++group)
      if (of_groups[group].level != BrickPlan::kTransparent)
        for_each_brick(sources, group, [&](std::size_t i) { plans[i] = planner.plan(i); });
  });
  return plans;
}

std::vector<std::uint32_t> list_drawn(const PlanSources& sources, std::span<const BrickPlan> of_groups,
                                      std::span<const BrickPlan> of_bricks) {
  std::vector<std::uint32_t> drawn;
  for (std::size_t group = 0; group < of_groups.size(); ++group) {
    if (of_groups[group].level == BrickPlan::kTransparent) continue;
    if (of_groups[group].level == BrickPlan::kWholeGroup) {
      drawn.push_back(static_cast<std::uint32_t>(of_bricks.size() + group));
      continue;
    }
    for_each_brick(sources, group, [&](std::size_t i) {
      if (of_bricks[i].level != BrickPlan::kTransparent) drawn.push_back(static_cast<std::uint32_t>(i));
    });
  }
  return drawn;
}

}  // namespace tetravox::scene
