#include "src/cpu/domain.h"
#include "tetravox/error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace tetravox::cpu {
namespace {

/// Axes of `count` variables, `size` entries each (one more from axis to axis), over [0, 1]; a few entries absorb.
OpticalTable make_sparse_table(std::size_t count, std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  OpticalTable table;
  std::size_t entries = 1;
  for (std::size_t axis = 0; axis < count; ++axis) {
    table.variables.push_back({axis == 0 ? VariableKind::kValue : VariableKind::kArray, {}, ValueRange{0, 1}});
    table.sizes.push_back(size + axis);
    entries *= size + axis;
  }
  table.entries.resize(entries);
  for (int i = 0; i < 5; ++i) table.entries[random() % entries].extinction = 1.0;
  return table;
}

/// Whether an entry absorbs between which and its neighbours something of the ranges lies.
bool is_transparent_by_looking(const OpticalTable& table, const std::array<ValueRange, 3>& ranges) {
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    std::size_t rest = i;
    bool is_near = table.entries[i].extinction > 0.0;
    for (std::size_t axis = 0; axis < table.sizes.size(); ++axis) {
      const double last = static_cast<double>(table.sizes[axis] - 1);
      const auto at = static_cast<double>(rest % table.sizes[axis]);
      is_near &= std::floor(ranges[axis].min * last) <= at && at <= std::ceil(ranges[axis].max * last);
      rest /= table.sizes[axis];
    }
    if (is_near) return false;
  }
  return true;
}

TEST(Domain, KnowsWhereATableIsTransparent) {
  std::mt19937 random(3);
  const auto draw = [&] { return static_cast<double>(random()) / 4294967295.0; };
  const DomainScalars scalars{{}, {0, 1}, 1.0, {{}, {}}};
  for (const std::size_t count : {2u, 3u}) {
    const OpticalTable table = make_sparse_table(count, 13, static_cast<std::uint32_t>(count));
    const Domain domain = make_table_domain(table, {}, scalars);
    TableOccupancy occupancy;
    build_occupancy(domain, 1e-3, 1.0, occupancy);
    int transparent = 0, found = 0;
    for (int i = 0; i < 2000; ++i) {
      std::array<ValueRange, 3> ranges;
      for (ValueRange& range : ranges) {
        range.min = 0.9 * draw();
        range.max = range.min + (1.0 - range.min) * draw() * draw();
      }
      const bool wanted = is_transparent_by_looking(table, ranges);
      const bool is_found = is_transparent(domain, occupancy, ranges);
      ASSERT_TRUE(wanted || !is_found) << count << " variables, " << i;
      transparent += wanted;
      found += is_found;
    }
    EXPECT_GT(transparent, 200);
    EXPECT_LT(transparent, 1900);
    EXPECT_GE(found, transparent - 20);  // a hair around each range counts, too
  }
}

TEST(Domain, ArraysAreThoseNamed) {
  const OpticalTable table = make_sparse_table(3, 16, 1);
  const DomainScalars scalars{{}, {0, 1}, 1.0, {{0.0, 1.0}, {5.0, 2.0}}};
  const Domain domain = make_table_domain(table, {1, 0}, scalars);
  EXPECT_FALSE(domain.others[0].has_value());
  EXPECT_EQ(domain.others[1], 1u);
  EXPECT_EQ(domain.others[2], 0u);
  EXPECT_FLOAT_EQ(domain.axes[1].first, -2.5f);
  EXPECT_FLOAT_EQ(domain.axes[1].entries_per_scalar, 32.0f);
  EXPECT_THROW(make_table_domain(table, {0}, scalars), Error);
  EXPECT_THROW(make_table_domain(table, {0, 2}, scalars), Error);
}

}  // namespace
}  // namespace tetravox::cpu
