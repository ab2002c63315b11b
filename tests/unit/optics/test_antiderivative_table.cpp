#include "src/optics/antiderivative_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tetravox::optics {
namespace {

const ScalarMap kMap{};

AntiderivativeTable build(const OpticalFunction& function, const ValueRange& range = {0.0, 1.0}, double longest = 1.0) {
  AntiderivativeTable table;
  build_antiderivative_table(function, kMap, range, longest, table);
  return table;
}

/// Mean of a channel's density between two nodes.
double mean_density(const AntiderivativeTable& table, std::int32_t a, std::int32_t b, int channel) {
  return static_cast<double>(table.density_per_unit) *
         (table.entries[b].sums[channel] - table.entries[a].sums[channel]) / (b - a);
}

TEST(AntiderivativeTable, HoldsTheIntegralsOfALinearFunction) {
  // rho = 2 s, red = s: the means over [0, 1] are 1 and 2/3.
  const AntiderivativeTable table = build({{{0.0, 0.0, {0, 0, 0}}, {1.0, 2.0, {1, 0, 0}}}});
  EXPECT_NEAR(mean_density(table, 0, table.last_node, 0), 1.0, 1e-6);
  EXPECT_NEAR(mean_density(table, 0, table.last_node, 1), 2.0 / 3.0, 1e-6);
  EXPECT_NEAR(mean_density(table, 0, table.last_node, 2), 0.0, 1e-9);
  EXPECT_NEAR(table.entries[table.last_node / 2].densities[0], 1.0, 1e-6);
  EXPECT_NEAR(table.entries[table.last_node / 2].densities[1], 0.5, 1e-6);
  EXPECT_FALSE(table.has_coarse);
}

TEST(AntiderivativeTable, DifferencesOfNeighboursAreExactHoweverLargeTheTotal) {
  // A plateau of 1e4 below, a faint region of 1 above.
  const AntiderivativeTable table =
      build({{{0.0, 1e4, {1, 1, 1}}, {0.5, 1e4, {1, 1, 1}}, {0.51, 1.0, {1, 1, 1}}, {1.0, 1.0, {1, 1, 1}}}});
  const std::int32_t at = table.last_node * 3 / 4;
  EXPECT_NEAR(mean_density(table, at, at + 64, 0), 1.0, 2e-3);
}

TEST(AntiderivativeTable, MarksSteps) {
  const AntiderivativeTable table =
      build({{{0.0, 0.0, {0, 0, 1}}, {0.5, 0.0, {0, 0, 1}}, {0.5, 2.0, {1, 0, 0}}, {1.0, 2.0, {1, 0, 0}}}});
  ASSERT_TRUE(table.has_coarse);
  const auto near = static_cast<std::int32_t>(0.5 * table.last_node);
  EXPECT_EQ(table.is_coarse[near], 1);
  EXPECT_EQ(table.is_coarse[near / 2], 0);
  EXPECT_FALSE(table.is_gentle);
}

TEST(AntiderivativeTable, MarksFeaturesFinerThanItsNodes) {
  const AntiderivativeTable table = build({{{0.0, 0.0, {1, 1, 1}},
                                            {0.5, 0.0, {1, 1, 1}},
                                            {0.500005, 1e5, {1, 1, 1}},
                                            {0.50001, 0.0, {1, 1, 1}},
                                            {1.0, 0.0, {1, 1, 1}}}});
  ASSERT_TRUE(table.has_coarse);
  EXPECT_NEAR(mean_density(table, 0, table.last_node, 0), 0.5, 1e-5) << "nothing of it is lost in the integral";
}

TEST(AntiderivativeTable, KnowsGentleFunctions) {
  EXPECT_TRUE(build({{{0.0, 0.1, {0, 0, 1}}, {1.0, 1.0, {1, 0, 0}}}}).is_gentle);
  EXPECT_FALSE(build({{{0.0, 0.0, {0, 0, 1}}, {0.01, 50.0, {1, 0, 0}}, {1.0, 0.0, {1, 0, 0}}}}).is_gentle);
}

TEST(AntiderivativeTable, CoversTheDataBeyondTheFunctionAndConstantData) {
  const OpticalFunction function{{{0.4, 1.0, {0, 0, 1}}, {0.6, 3.0, {1, 0, 0}}}};
  const AntiderivativeTable wide = build(function);
  EXPECT_LE(wide.first, 0.21f);
  EXPECT_EQ(wide.density_below[0], 1.0f);
  EXPECT_EQ(wide.density_above[0], 3.0f);
  const AntiderivativeTable constant = build(function, {0.5, 0.5});
  EXPECT_NEAR(constant.entries[constant.last_node / 2].densities[0], 2.0, 1e-4);
}

TEST(AntiderivativeTable, ColourVariationCountsWhatIsSeen) {
  // The colour changes where nothing is visible: it counts once it is seen again.
  const AntiderivativeTable table = build({{{0.0, 1.0, {1, 0, 0}},
                                            {0.3, 1.0, {1, 0, 0}},
                                            {0.31, 0.0, {1, 0, 0}},
                                            {0.69, 0.0, {0, 1, 0}},
                                            {0.7, 1.0, {0, 1, 0}},
                                            {1.0, 1.0, {0, 1, 0}}}});
  EXPECT_NEAR(table.color_variation.front(), 0.0f, 1e-6f);
  EXPECT_NEAR(table.color_variation.back(), 1.0f, 1e-3f);
}

}  // namespace
}  // namespace tetravox::optics
