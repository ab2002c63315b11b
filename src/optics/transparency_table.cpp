#include "src/optics/transparency_table.h"

#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetravox::optics {
namespace {

/// exp(-x) * integral of exp(...) pieces: 8-point Gauss-Legendre on [a, b].
double integrate_piece(double d0, double d1, double a, double b) {
  static constexpr std::array<double, 4> kNodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                                0.9602898564975363};
  static constexpr std::array<double, 4> kWeights{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                  0.1012285362903763};
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  const auto absorbed = [&](double t) { return -std::expm1(-t * (d0 + 0.5 * (d1 - d0) * t)); };
  double sum = 0.0;
  for (std::size_t i = 0; i < kNodes.size(); ++i)
    sum += kWeights[i] * (absorbed(middle - half * kNodes[i]) + absorbed(middle + half * kNodes[i]));
  return sum * half;
}

}  // namespace

double eval_absorbed(double d0, double d1) {
  // Pieces over which the optical depth grows by about one; beyond depth 40 everything is absorbed.
  double t = 0.0, sum = 0.0;
  while (t < 1.0) {
    const double depth = t * (d0 + 0.5 * (d1 - d0) * t);
    if (depth > 40.0) return sum + (1.0 - t);
    const double rate = d0 + (d1 - d0) * t;
    const double curvature = std::sqrt(std::abs(d1 - d0) + 1e-300);
    const double step = std::min({1.0 - t, 1.0 / std::max(rate, 1e-300), 1.0 / curvature});
    const double next = step >= 1.0 - t ? 1.0 : t + step;
    sum += integrate_piece(d0, d1, t, next);
    t = next;
  }
  return sum;
}

const TransparencyTable& transparency_table() {
  static const TransparencyTable table = [] {
    constexpr int kSize = TransparencyTable::kSize;
    TransparencyTable made;
    made.absorbed.resize(static_cast<std::size_t>(kSize + 1) * (kSize + 1));
    // The last node stands for infinite depth.
    const auto depth_of = [](int node) { return node == kSize ? 1e30 : node / static_cast<double>(kSize - node); };
    support::parallel_chunks(kSize + 1, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        for (int column = 0; column <= kSize; ++column)
          made.absorbed[row * (kSize + 1) + column] =
              static_cast<float>(eval_absorbed(depth_of(static_cast<int>(row)), depth_of(column)));
    });
    return made;
  }();
  return table;
}

}  // namespace tetravox::optics
