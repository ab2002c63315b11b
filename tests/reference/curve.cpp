#include "tests/reference/curve.h"

#include "tests/reference/quadrature.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace tetravox::reference {
namespace {

double binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}

/// Matrix that turns samples at `sample_place` into Bernstein coefficients: the inverse of the basis there.
std::vector<double> make_fit(int degree) {
  const int n = degree + 1;
  std::vector<long double> rows(2 * static_cast<std::size_t>(n) * n);
  const auto at = [&](int i, int j) -> long double& { return rows[static_cast<std::size_t>(i) * 2 * n + j]; };
  for (int i = 0; i < n; ++i) {
    const long double u = sample_place(degree, i);
    for (int j = 0; j < n; ++j)
      at(i, j) = binomial(degree, j) * std::pow(u, static_cast<long double>(j)) *
                 std::pow(1 - u, static_cast<long double>(degree - j));
    at(i, n + i) = 1.0;
  }
  for (int column = 0; column < n; ++column) {
    int pivot = column;
    for (int i = column; i < n; ++i)
      if (std::abs(at(i, column)) > std::abs(at(pivot, column))) pivot = i;
    for (int j = 0; j < 2 * n; ++j) std::swap(at(column, j), at(pivot, j));
    for (int i = 0; i < n; ++i) {
      const long double factor = at(i, column) / at(column, column);
      if (i != column)
        for (int j = 0; j < 2 * n; ++j) at(i, j) -= factor * at(column, j);
    }
  }
  std::vector<double> fit;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) fit.push_back(static_cast<double>(at(i, n + j) / at(i, i)));
  return fit;
}

/// Where a monotone curve has this value, by bisection between two places that have it between them.
double find_place(const Curve& curve, double value, double u0, double u1) {
  const bool rises = curve.bernstein[curve.degree] > curve.bernstein[0];
  for (int i = 0; i < 55; ++i) {
    const double middle = 0.5 * (u0 + u1);
    ((curve.eval(middle) < value) == rises ? u0 : u1) = middle;
  }
  return 0.5 * (u0 + u1);
}

/// The pieces of a function between two values: those that end at control points first ... last.
struct Pieces {
  std::size_t first, last;
};

bool is_transparent(const OpticalFunction& function, const Pieces& pieces) {
  const std::size_t begin = pieces.first == 0 ? 0 : pieces.first - 1;
  const std::size_t end = std::min(pieces.last, function.points.size() - 1);
  for (std::size_t i = begin; i <= end; ++i)
    if (function.points[i].extinction > 0.0) return false;
  return true;
}

/// Part [u0, u1] of a curve, within one linear piece of the function.
void append_piece(const OpticalFunction& function, std::size_t upper, const Curve& scalar, double u0, double u1,
                  double length, RayIntegral& ray) {
  if (!(u1 > u0) || is_transparent(function, {upper, upper})) return;
  const auto density_at = [&](double u) {
    const OpticalPoint point = eval_piece(function, upper, scalar.eval(u));
    Density density{std::max(point.extinction, 0.0), {}};
    for (int k = 0; k < 3; ++k) density.emission[k] = density.extinction * point.color[k];
    return density;
  };
  append_stretch(density_at, u0, u1, length, ray);
}

/// A curve that rises or falls throughout meets each control point between its ends once.
void append_monotone(const OpticalFunction& function, const Pieces& pieces, const Curve& scalar, double length,
                     RayIntegral& ray) {
  const bool rises = scalar.bernstein[scalar.degree] > scalar.bernstein[0];
  double u = 0.0;
  for (std::size_t i = 0; i <= pieces.last - pieces.first; ++i) {
    const std::size_t upper = rises ? pieces.first + i : pieces.last - i;
    const bool is_step =
        upper > 0 && upper < function.points.size() && function.points[upper - 1].value == function.points[upper].value;
    if (is_step) continue;
    const bool is_end = upper == (rises ? pieces.last : pieces.first);
    const double next = is_end ? 1.0 : find_place(scalar, function.points[rises ? upper : upper - 1].value, u, 1.0);
    append_piece(function, upper, scalar, u, next, length, ray);
    u = next;
  }
}

void append_halving(const OpticalFunction& function, const Curve& scalar, double length, int halvings,
                    RayIntegral& ray) {
  if (ray.optical_depth >= kOpaque) return;
  const double low = scalar.low(), high = scalar.high();
  const Pieces pieces{find_piece(function, low), find_piece(function, high)};
  if (is_transparent(function, pieces)) return;
  if (pieces.first == pieces.last) return append_piece(function, pieces.first, scalar, 0.0, 1.0, length, ray);
  if (scalar.is_monotone()) return append_monotone(function, pieces, scalar, length, ray);
  // Where rounding alone bends the curve it is straight.
  const double rounding = 1e-13 * std::max(std::abs(low), std::abs(high));
  constexpr int kMostHalvings = 40;
  if (high - low <= rounding || halvings == kMostHalvings)
    return append_segment(function, scalar.bernstein[0], scalar.bernstein[scalar.degree], length, ray);
  for (const Curve& half : scalar.split()) append_halving(function, half, 0.5 * length, halvings + 1, ray);
}

}  // namespace

double Curve::eval(double u) const {
  // Horner's scheme for Bernstein's basis.
  const double v = 1.0 - u;
  double power = 1.0, coefficient = 1.0, sum = bernstein[0] * v;
  for (int i = 1; i < degree; ++i) {
    power *= u;
    coefficient = coefficient * (degree - i + 1) / i;
    sum = (sum + power * coefficient * bernstein[i]) * v;
  }
  return sum + power * u * bernstein[degree];
}

double Curve::low() const { return *std::min_element(bernstein.begin(), bernstein.begin() + degree + 1); }

double Curve::high() const { return *std::max_element(bernstein.begin(), bernstein.begin() + degree + 1); }

bool Curve::is_monotone() const {
  const auto end = bernstein.begin() + degree + 1;
  return std::is_sorted(bernstein.begin(), end) || std::is_sorted(bernstein.begin(), end, std::greater<>());
}

std::array<Curve, 2> Curve::split() const {
  std::array<Curve, 2> halves{*this, *this};
  // De Casteljau's scheme: each round of means ends one more coefficient of either half.
  std::array<double, kLargestDegree + 1>& means = halves[1].bernstein;
  for (int round = 1; round <= degree; ++round) {
    for (int i = 0; i <= degree - round; ++i) means[i] = 0.5 * (means[i] + means[i + 1]);
    halves[0].bernstein[round] = means[0];
  }
  return halves;
}

double sample_place(int degree, int index) { return 0.5 - 0.5 * std::cos(std::numbers::pi * index / degree); }

Curve fit_curve(int degree, const double* samples) {
  static const std::vector<double> kCubic = make_fit(3), kNinth = make_fit(9);
  const std::vector<double>& fit = degree == 3 ? kCubic : kNinth;
  Curve curve;
  curve.degree = degree;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; j <= degree; ++j)
      curve.bernstein[i] += fit[static_cast<std::size_t>(i) * (degree + 1) + j] * samples[j];
  return curve;
}

void append_curve(const OpticalFunction& function, const Curve& scalar, double length, RayIntegral& ray) {
  append_halving(function, scalar, length, 0, ray);
}

void append_densities(const DensityCurves& density, double length, RayIntegral& ray) {
  if (density.extinction.high() <= 0.0) return;
  append_stretch(
      [&](double u) {
        Density result{std::max(density.extinction.eval(u), 0.0), {}};
        for (int k = 0; k < 3; ++k)
          result.emission[k] = std::clamp(density.emission[k].eval(u), 0.0, result.extinction);
        return result;
      },
      0.0, 1.0, length, ray);
}

}  // namespace tetravox::reference
