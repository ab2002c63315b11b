#include "src/scene/brick_groups.h"

#include "src/optics/antiderivative_table.h"
#include "src/optics/steepness_table.h"
#include "src/scene/brick_plan.h"
#include "tests/common/grid_builder.h"
#include "tetravox/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::scene {
namespace {

/// Ripples in the lower half (z < 0), a constant above.
double half_rippled(const Vector3& p) { return p[2] < 0.0 ? 0.5 + 0.4 * std::sin(9.0 * p[0]) * p[2] : 0.5; }

PreparedGrid make_subject(const tests::Field& field, const std::array<std::uint32_t, 3>& points = {100, 67, 131}) {
  tests::GridOptions options;
  options.dimensions = points;
  return prepare_grid(tests::make_grid(options, field));
}

/// What plans are made of, for a function.
struct Subject {
  PreparedGrid grid;
  FilteredField field;
  BrickGroups groups;
  optics::SteepnessTable steepness;

  Subject(PreparedGrid prepared, const OpticalFunction& function)
      : grid(std::move(prepared)), groups(make_brick_groups(grid, field)) {
    const optics::ScalarMap map{grid.scalar_offset, grid.scalar_scale};
    optics::build_steepness_table(optics::build_control_point_table(function, map),
                                  map.stored_from_value(grid.scalar_range.min),
                                  map.stored_from_value(grid.scalar_range.max), steepness);
  }
  PlanSources sources() const { return {&grid, &field, &steepness, 1e-4f, 3.5, false, false, {}, &groups}; }
};

/// Transparent below 0.7.
const OpticalFunction kHighOnly{{{0.7, 0.0, {1, 0, 0}}, {1.0, 5.0, {0, 1, 0}}}};
const OpticalFunction kEverything{{{0.0, 1.0, {1, 0, 0}}, {1.0, 3.0, {0, 0, 1}}}};

TEST(BrickGroups, BoundTheirBricks) {
  for (const bool has_missing : {false, true}) {
    const PreparedGrid grid = make_subject([&](const Vector3& p) {
      return has_missing && p[0] > 0.9 ? std::numeric_limits<double>::quiet_NaN() : half_rippled(p);
    });
    const BrickGroups groups = make_brick_groups(grid, {});
    EXPECT_EQ(groups.counts, (std::array<std::uint32_t, 3>{4, 3, 5}));
    std::size_t seen = 0;
    for (std::size_t group = 0; group < groups.count(); ++group) {
      const BrickSpan span = bricks_of_group(grid, groups, group);
      float min = std::numeric_limits<float>::infinity(), max = -min;
      bool is_missing = false;
      for (std::uint32_t k = span.first[2]; k < span.end[2]; ++k)
        for (std::uint32_t j = span.first[1]; j < span.end[1]; ++j)
          for (std::uint32_t i = span.first[0]; i < span.end[0]; ++i, ++seen) {
            const std::size_t brick =
                (static_cast<std::size_t>(k) * grid.bricks.counts[1] + j) * grid.bricks.counts[0] + i;
            min = std::min(min, grid.bricks.min[brick]);
            max = std::max(max, grid.bricks.max[brick]);
            is_missing |= grid.bricks.has_missing[brick] != 0;
          }
      EXPECT_EQ(groups.min[group], min) << group;
      EXPECT_EQ(groups.max[group], max) << group;
      EXPECT_EQ(groups.has_missing[group] != 0, is_missing) << group;
    }
    EXPECT_EQ(seen, grid.bricks.count()) << "each brick belongs to one group";
  }
}

TEST(BrickGroups, HaveTheCellsOfTheirBricks) {
  const PreparedGrid grid = make_subject(half_rippled);
  const BrickGroups groups = make_brick_groups(grid, {});
  for (std::size_t group = 0; group < groups.count(); ++group) {
    const auto number = static_cast<std::uint32_t>(grid.bricks.count() + group);
    const BrickSpan span = bricks_of_group(grid, groups, group);
    ASSERT_TRUE(is_group(grid, number));
    const grid::BrickBox box = box_of_drawn(grid, number);
    const grid::BrickBox first = grid::box_of_brick(grid.data.shape, span.first);
    const grid::BrickBox last =
        grid::box_of_brick(grid.data.shape, {span.end[0] - 1, span.end[1] - 1, span.end[2] - 1});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(box.first[axis], first.first[axis]);
      EXPECT_EQ(box.first[axis] + box.count[axis], last.first[axis] + last.count[axis]);
    }
  }
}

TEST(BrickGroups, LeavePlansAsTheyAre) {
  for (const OpticalFunction& function : {kHighOnly, kEverything}) {
    const Subject subject(make_subject(half_rippled), function);
    const PlanSources sources = subject.sources();
    const std::vector<BrickPlan> of_groups = plan_groups(sources, {}), alone = plan_bricks(sources, {});
    const std::vector<BrickPlan> plans = plan_bricks(sources, {}, of_groups);
    for (std::size_t i = 0; i < plans.size(); ++i) {
      EXPECT_EQ(plans[i].level, alone[i].level) << i;
      EXPECT_EQ(plans[i].stride, alone[i].stride) << i;
    }
    const auto count = [&](std::uint8_t level) {
      return std::count_if(of_groups.begin(), of_groups.end(), [&](const BrickPlan& p) { return p.level == level; });
    };
    const bool is_all_seen = function.points.front().extinction > 0.0;
    EXPECT_GT(count(is_all_seen ? BrickPlan::kWholeGroup : BrickPlan::kTransparent), 10);
    EXPECT_GT(count(0), 10);
  }
}

TEST(BrickGroups, AreDrawnOnceWithAllBricks) {
  const Subject subject(make_subject(half_rippled), kEverything);
  const PlanSources sources = subject.sources();
  const std::vector<BrickPlan> of_groups = plan_groups(sources, {}), plans = plan_bricks(sources, {}, of_groups);
  std::int64_t cells = 0;
  for (const std::uint32_t drawn : list_drawn(sources, of_groups, plans)) {
    const grid::BrickBox box = box_of_drawn(subject.grid, drawn);
    cells += box.count[0] * box.count[1] * box.count[2];
  }
  EXPECT_EQ(cells, 99 * 66 * 130);
}

Image draw(const PreparedGrid& grid, const OpticalFunction& function, const RenderSettings& settings,
           RenderStatistics* statistics = nullptr) {
  Camera camera;
  camera.position = {3.0, 2.0, 4.0};
  camera.focal_point = {0, 0, 0};
  camera.view_up = {0, 1, 0};
  Renderer renderer(grid);
  renderer.set_transfer_function(function);
  return renderer.render(camera, settings, statistics);
}

TEST(BrickGroups, DrawHomogeneousRunsAtOnce) {
  const PreparedGrid grid = make_subject(half_rippled, {129, 129, 129});
  const PreparedGrid constant = make_subject([](const Vector3&) { return 0.5; }, {129, 129, 129});
  RenderSettings settings;
  settings.width = settings.height = 96;
  RenderStatistics statistics;
  draw(constant, kEverything, settings, &statistics);
  EXPECT_GT(statistics.rays, 3000u);
  EXPECT_LE(statistics.segments, 20 * statistics.rays) << "of 128 cells along each axis";
  const Image image = draw(grid, kEverything, settings);
  settings.integrator = Integrator::kPartial;
  settings.tolerance = 1e-6;
  const Image exact = draw(grid, kEverything, settings);
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) ASSERT_NEAR(image.pixels[i], exact.pixels[i], 1e-3) << i;
}

}  // namespace
}  // namespace tetravox::scene
