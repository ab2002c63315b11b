#pragma once

/// The trilinear field of a cell along a line, in double precision.

#include <algorithm>
#include <array>
#include <cmath>

namespace tetravox::cpu {

/// c[0] + c[1] t + c[2] t^2 + c[3] t^3.
using Cubic = std::array<double, 4>;

inline double eval_cubic(const Cubic& c, double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }

inline double eval_cubic_slope(const Cubic& c, double t) { return c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]); }

/// The field of a cell along a line that runs from `at` to `at` + `step` in it, both in units of the cell, for t in
/// [0, 1]. Corners: x first.
inline Cubic make_cubic(const std::array<double, 8>& v, const std::array<double, 3>& at,
                        const std::array<double, 3>& step) {
  const double x = v[1] - v[0], y = v[2] - v[0], z = v[4] - v[0];
  const double xy = v[3] - v[2] - x, xz = v[5] - v[4] - x, yz = v[6] - v[4] - y;
  const double xyz = v[7] - v[6] - v[5] + v[4] - xy;
  const auto [a, b, c] = at;
  const auto [p, q, r] = step;
  return {v[0] + x * a + y * b + z * c + xy * a * b + xz * a * c + yz * b * c + xyz * a * b * c,
          x * p + y * q + z * r + xy * (a * q + b * p) + xz * (a * r + c * p) + yz * (b * r + c * q) +
              xyz * (a * b * r + a * c * q + b * c * p),
          xy * p * q + xz * p * r + yz * q * r + xyz * (a * q * r + b * p * r + c * p * q), xyz * p * q * r};
}

/// Bound on the distance from the chord over [0, 1]: t (t - 1) (c2 + c3 (1 + t)).
inline double bend_of(const Cubic& c) { return 0.25 * std::max(std::abs(c[2] + c[3]), std::abs(c[2] + 2.0 * c[3])); }

/// Ends of the pieces of [0, 1] in which the cubic is monotone: 0, its extrema, 1. Returns how many.
inline int split_at_extrema(const Cubic& c, std::array<double, 4>& ends) {
  ends[0] = 0.0;
  int count = 1;
  const double a = 3.0 * c[3], half_b = c[2], d = half_b * half_b - a * c[1];
  if (d > 0.0) {
    // The sum without cancellation gives one root, the product of the roots the other.
    const double sum = -(half_b + std::copysign(std::sqrt(d), half_b));
    double first = a != 0.0 ? sum / a : -1.0, second = sum != 0.0 ? c[1] / sum : -1.0;
    if (first > second) std::swap(first, second);
    for (const double t : {first, second})
      if (t > ends[count - 1] && t < 1.0) ends[count++] = t;
  }
  ends[count++] = 1.0;
  return count;
}

}  // namespace tetravox::cpu
