#pragma once

/// How each brick of a grid is drawn, before a ray has entered it.

#include "src/optics/steepness_table.h"
#include "src/scene/brick_groups.h"
#include "src/scene/filtered_field.h"
#include "tetravox/grid.h"
#include "tetravox/render.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace tetravox::scene {

struct BrickPlan {
  static constexpr std::uint8_t kTransparent = 0xFF;

  static constexpr std::uint8_t kWholeGroup = 5;  ///< level of a group that is a single cell

  std::uint8_t level = kTransparent;  ///< lattice cells of 2^level cells a side
  std::uint8_t stride = 0;            ///< lattice cells a step; 0: from cell to cell
  bool is_curved = false;             ///< whether rays in its cells may be bent too much to be chords
  bool is_gentle = false;             ///< whether scalars may be rounded to nodes of the table
};

/// What plans depend on beside data and function.
struct PlanSettings {
  Filter filter;
  Integrator integrator = Integrator::kAntiderivative;
  double tolerance = 0.002;
  double samples_per_voxel = 0.0;
  bool wants_gradients = false;       ///< values are not thinned out then, and steps are short
  std::vector<float> surface_values;  ///< stored scalars, ascending: where one occurs a brick is drawn

  bool operator==(const PlanSettings&) const = default;
};

/// Whether anything is to be seen in a brick, where more than its values says so; `range`: stored scalars of the value.
using IsSeen = std::function<bool(std::size_t brick, const ValueRange& range)>;

/// Data and function.
struct PlanSources {
  const PreparedGrid* grid = nullptr;  ///< as it is drawn: `FilteredField::middles` where there are such
  const FilteredField* field = nullptr;
  const optics::SteepnessTable* steepness = nullptr;
  float node_width = 0.0f;   ///< stored scalars from node to node of the antiderivatives' table
  double diagonal = 1.0;     ///< world length of the longest ray
  bool is_constant = false;  ///< whether the scalar is constant in each cell
  bool is_by_cells = false;  ///< whether rays go from cell to cell in any case
  IsSeen is_seen;            ///< empty: what `steepness` says
  const BrickGroups* groups = nullptr;
};

/// Whether values are equally far apart along each axis.
bool has_even_axes(const PreparedGrid& grid);

/// Error in colour for one unit of world length that segments may have.
float allowed_rate_of(double tolerance, double diagonal);

/// Linear pieces that a cell is cut into at most.
float most_pieces_of(double tolerance);

/// Extinction, per world length, that counts as none.
float allowed_haze_of(double tolerance, double diagonal);

/// Range of the field in a brick; min > max where it is missing throughout.
ValueRange range_of(const PlanSources& sources, std::size_t brick);

/// One plan a group (`sources.groups`): transparent; or a single lattice cell, where the function cannot tell what is
/// in it from a trilinear field; otherwise level 0: brick by brick.
std::vector<BrickPlan> plan_groups(const PlanSources& sources, const PlanSettings& settings);

/// One plan a brick. Where there are plans of groups, the bricks of those that are transparent are not looked at.
/// Microseconds for a thousand bricks, on all cores.
std::vector<BrickPlan> plan_bricks(const PlanSources& sources, const PlanSettings& settings,
                                   std::span<const BrickPlan> of_groups = {});

/// What is to be drawn, numbered as in brick_groups.h: groups that are single cells, and other bricks that are seen.
std::vector<std::uint32_t> list_drawn(const PlanSources& sources, std::span<const BrickPlan> of_groups,
                                      std::span<const BrickPlan> of_bricks);

}  // namespace tetravox::scene
