#include "src/optics/transparency_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace tetravox::optics {
namespace {

TEST(TransparencyTable, QuadratureAgreesWithClosedForms) {
  for (const double d : {1e-6, 1e-3, 0.1, 1.0, 5.0, 50.0, 1e4})
    EXPECT_NEAR(1.0 - eval_absorbed(d, d), -std::expm1(-d) / d, 1e-12) << d;
  // Extinction from 0: psi is an error function.
  for (const double d : {0.01, 1.0, 7.0, 300.0}) {
    const double root = std::sqrt(0.5 * d);
    EXPECT_NEAR(1.0 - eval_absorbed(0.0, d), 0.5 * std::sqrt(std::acos(-1.0)) * std::erf(root) / root, 1e-11) << d;
  }
}

TEST(TransparencyTable, InterpolatesWithinItsError) {
  const TransparencyTable& table = transparency_table();
  constexpr int kSize = TransparencyTable::kSize;
  const auto look_up = [&](double d0, double d1) {
    const double row = kSize * d0 / (d0 + 1.0), column = kSize * d1 / (d1 + 1.0);
    const int i = static_cast<int>(row), j = static_cast<int>(column);
    const double v = row - i, u = column - j;
    const auto at = [&](int a, int b) {
      return static_cast<double>(table.absorbed[static_cast<std::size_t>(a) * (kSize + 1) + b]);
    };
    return (1 - v) * ((1 - u) * at(i, j) + u * at(i, j + 1)) + v * ((1 - u) * at(i + 1, j) + u * at(i + 1, j + 1));
  };
  for (double d0 = 0.0; d0 <= 8.0; d0 += 0.0731)
    for (double d1 = 0.0; d1 <= 8.0; d1 += 0.0917)
      EXPECT_NEAR(look_up(d0, d1), eval_absorbed(d0, d1), 2e-5) << d0 << " " << d1;
}

}  // namespace
}  // namespace tetravox::optics
