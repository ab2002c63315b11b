#include "src/mesh/space_filling_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

namespace tetravox::mesh {
namespace {

TEST(SpaceFillingOrder, NeighboursAlongTheCurveAreNeighboursInTheLattice) {
  std::vector<std::pair<std::uint64_t, std::array<std::uint32_t, 3>>> curve;
  for (std::uint32_t z = 0; z < 16; ++z)
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t x = 0; x < 16; ++x) curve.push_back({hilbert_index({x, y, z}), {x, y, z}});
  std::sort(curve.begin(), curve.end());
  for (std::size_t i = 1; i < curve.size(); ++i) {
    EXPECT_EQ(curve[i].first, curve[i - 1].first + 1);
    int steps = 0;
    for (int axis = 0; axis < 3; ++axis)
      steps += std::abs(static_cast<int>(curve[i].second[axis]) - static_cast<int>(curve[i - 1].second[axis]));
    EXPECT_EQ(steps, 1);
  }
}

TEST(SpaceFillingOrder, PointsOfTheDomainsCornersAreInside) {
  const CurveDomain domain{{-8e307, -8e307, -8e307}, 8.5e307};
  const double low[3] = {-1.6e308, -1.6e308, -1.6e308}, high[3] = {1.7e308, 1.7e308, 1.7e308};
  EXPECT_LT(hilbert_index(low, domain), std::uint64_t{1} << 63);
  EXPECT_LT(hilbert_index(high, domain), std::uint64_t{1} << 63);
  const CurveDomain flat{{0, 0, 0}, 0.0};
  EXPECT_EQ(hilbert_index(low, flat), 0u);
}

}  // namespace
}  // namespace tetravox::mesh
