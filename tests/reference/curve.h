#pragma once

/// Emission and absorption along a stretch of a ray on which the scalar is a polynomial, in double precision.

#include "tests/reference/segment.h"

#include <array>

namespace tetravox::reference {

inline constexpr int kLargestDegree = 9;

/// A polynomial on [0, 1] by its Bernstein coefficients: its values lie between the least and the largest of them.
struct Curve {
  int degree = 3;
  std::array<double, kLargestDegree + 1> bernstein{};

  double eval(double u) const;
  double low() const;
  double high() const;
  bool is_monotone() const;
  /// The halves, each on [0, 1].
  std::array<Curve, 2> split() const;
};

/// Places in [0, 1] where a polynomial of this degree (3 or 9) is sampled, from end to end; `degree + 1` of them.
double sample_place(int degree, int index);

/// The polynomial that goes through the samples.
Curve fit_curve(int degree, const double* samples);

/// Adds a stretch of this length, with the function of the scalar, behind what `ray` holds: it is cut at the extrema of
/// the scalar and where the scalar meets a control point, and each piece is integrated to 1e-11.
void append_curve(const OpticalFunction& function, const Curve& scalar, double length, RayIntegral& ray);

/// Adds a stretch on which extinction (at least 0) and emission (in [0, extinction]) are polynomials, clamped to that.
struct DensityCurves {
  Curve extinction;
  std::array<Curve, 3> emission;
};
void append_densities(const DensityCurves& density, double length, RayIntegral& ray);

}  // namespace tetravox::reference
