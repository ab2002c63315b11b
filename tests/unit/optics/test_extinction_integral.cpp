#include "src/optics/extinction_integral.h"

#include "tests/common/functions.h"

#include <gtest/gtest.h>

#include <random>

namespace tetravox::optics {
namespace {

/// By a midpoint rule. Stored scalars.
double sample_mean(const OpticalFunction& function, const ScalarMap& map, double a, double b) {
  constexpr int kSteps = 4000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i)
    sum += eval_optical_function(function, map.offset + (a + (b - a) * (i + 0.5) / kSteps) * map.scale).extinction;
  return sum / kSteps;
}

TEST(ExtinctionIntegral, MeansAreThoseOfTheFunction) {
  std::mt19937 twister(3);
  const auto pick = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(twister); };
  for (const auto& [name, function] : tests::make_hard_functions({0.0, 1.0}, 2.0)) {
    const ScalarMap map{0.5, 0.25};
    const ExtinctionIntegral integral(function, map);
    for (int i = 0; i < 60; ++i) {
      const double a = pick(-3.0, 3.0), b = i % 3 == 0 ? a + pick(-1e-3, 1e-3) : pick(-3.0, 3.0);
      const double wanted = sample_mean(function, map, a, b);
      EXPECT_NEAR(integral.mean(a, b), wanted, 2e-3 * (1.0 + wanted)) << name << " " << a << " " << b;
      EXPECT_DOUBLE_EQ(integral.mean(a, a), integral.extinction(a)) << name;
    }
  }
}

TEST(ExtinctionIntegral, IsExactInAndAcrossPieces) {
  const OpticalFunction function{{{0.0, 1.0, {}}, {1.0, 3.0, {}}, {1.0, 7.0, {}}, {2.0, 5.0, {}}}};
  const ExtinctionIntegral integral(function, {});
  EXPECT_DOUBLE_EQ(integral.mean(0.0, 1.0), 2.0);
  EXPECT_DOUBLE_EQ(integral.mean(0.25, 0.75), 2.0);
  EXPECT_DOUBLE_EQ(integral.mean(2.0, 0.0), 4.0);
  EXPECT_DOUBLE_EQ(integral.mean(-2.0, -1.0), 1.0);
  EXPECT_DOUBLE_EQ(integral.mean(4.0, 2.0), 5.0);
  EXPECT_DOUBLE_EQ(integral.mean(-1.0, 3.0), 3.5);
  EXPECT_DOUBLE_EQ(integral.mean(1.0 - 1e-15, 1.0 + 1e-15), 5.0);  // a step, and nothing to divide by
}

}  // namespace
}  // namespace tetravox::optics
