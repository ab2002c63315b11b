#include "src/scene/fixed_rate.h"

#include "src/grid/frame.h"
#include "src/optics/slab_table.h"
#include "src/scene/frame_renderer.h"

#include <algorithm>

namespace tetravox::scene {
namespace {

/// Kernels count steps and cells in floats, and bytes in 32 bits.
constexpr double kMostSteps = 1 << 22;
constexpr std::uint32_t kMostPoints = 1u << 22;
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 32;

/// Of so many along the longest ray the length is known well enough to tell a whole slab from a part of one.
constexpr double kMostSlabs = 1 << 13;

/// Steps along the longest ray.
double count_steps(const PreparedGrid& grid, double samples_per_voxel) {
  return diagonal_of(grid.bounds) / grid::mean_spacing(grid::make_grid_frame(grid.data.shape)) * samples_per_voxel;
}

bool is_exact(Integrator integrator) {
  return integrator == Integrator::kAntiderivative || integrator == Integrator::kPartial;
}

bool is_read_in_place(ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8:
    case ScalarType::kInt16:
    case ScalarType::kUint16:
    case ScalarType::kFloat32:
      return true;
    default:
      return false;
  }
}

}  // namespace

bool restarts_rate(const PreparedGrid& grid, Integrator integrator) {
  return is_exact(integrator) && has_even_axes(grid) && grid.missing_values == 0;
}

std::string find_obstacle_to_counting(const PreparedGrid& grid, const RenderSettings& settings) {
  const GridData& data = grid.data;
  const auto& points = data.shape.dimensions;
  if (!is_exact(settings.integrator)) return "pre-integration (the integrator 'antiderivative' or 'partial')";
  if (settings.filter.kind != FilterKind::kLinear) return "the filter 'linear'";
  if (!has_even_axes(grid)) return "a grid with even axes";
  if (grid.missing_values != 0) return "a grid without missing values";
  if (data.association != Association::kPoint) return "values at the points of a grid, not in its cells";
  if (data.components != 1) return "a grid of one component";
  if (!is_read_in_place(data.type)) return "values of 8 or 16 bits or of type float32";
  if (data.values.size() > kMostBytes || *std::max_element(points.begin(), points.end()) > kMostPoints)
    return "a grid of at most 4 GiB";
  if (grid.scalar_offset != 0.0 || !(grid.scalar_scale > 1e-30 && grid.scalar_scale < 1e30))
    return "values whose range is at least half of the largest one";
  if (!(count_steps(grid, settings.samples_per_voxel) <= kMostSteps)) return "fewer samples along a ray";
  return {};
}

bool counts_steps(const PreparedGrid& grid, const RenderSettings& settings) {
  return settings.samples_per_voxel > 0.0 && find_obstacle_to_counting(grid, settings).empty();
}

bool may_look_slabs_up(const PreparedGrid& grid, const optics::SteepnessTable& steepness,
                       const RenderSettings& settings) {
  const ValueRange stored = stored_range(grid);
  const float most = steepness.largest_steepness(static_cast<float>(stored.min), static_cast<float>(stored.max));
  return settings.integrator == Integrator::kAntiderivative &&
         count_steps(grid, settings.samples_per_voxel) <= kMostSlabs &&
         optics::rounding_error(stored, most, diagonal_of(grid.bounds)) <= settings.tolerance;
}

ValueRange stored_range(const PreparedGrid& grid) {
  const auto stored = [&](double value) { return (value - grid.scalar_offset) / grid.scalar_scale; };
  return {stored(grid.scalar_range.min), stored(grid.scalar_range.max)};
}

std::vector<std::uint8_t> list_seen_spans(const std::array<std::uint32_t, 3>& counts,
                                          std::span<const BrickPlan> plans) {
  std::vector<std::uint8_t> spans(plans.size());
  for (std::size_t i = 0; i < plans.size(); ++i) spans[i] = plans[i].level != BrickPlan::kTransparent;
  // Spans with an axis are those without it, of the brick and of the next one along the axis.
  std::size_t stride = 1;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned known = (1u << (1u << axis)) - 1u;
    for (std::size_t i = 0; i < spans.size(); ++i) {
      const bool has_next = i / stride % counts[axis] + 1 < counts[axis];
      const unsigned here = spans[i] & known, next = has_next ? spans[i + stride] & known : 0u;
      spans[i] = static_cast<std::uint8_t>(here | (here | next) << (1u << axis));
    }
    stride *= counts[axis];
  }
  return spans;
}

std::vector<std::uint32_t> list_seen_groups(std::size_t brick_count, std::span<const BrickPlan> of_groups) {
  std::vector<std::uint32_t> seen;
  for (std::size_t group = 0; group < of_groups.size(); ++group)
    if (of_groups[group].level != BrickPlan::kTransparent)
      seen.push_back(static_cast<std::uint32_t>(brick_count + group));
  return seen;
}

}  // namespace tetravox::scene
