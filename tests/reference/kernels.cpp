#include "tests/reference/kernels.h"

#include <cmath>
#include <numbers>

namespace tetravox::reference {
namespace {

/// Mitchell and Netravali's family of cubics: (1, 0) is the B-spline, (0, 1/2) Catmull and Rom's, (1/3, 1/3) their own.
double cubic(double x, double b, double c) {
  x = std::abs(x);
  if (x >= 2.0) return 0.0;
  if (x >= 1.0)
    return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6.0;
  return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6.0;
}

double sinc(double x) {
  const double y = std::numbers::pi * x;
  return std::abs(y) < 1e-9 ? 1.0 : std::sin(y) / y;
}

double eval_kernel(const Filter& filter, double x) {
  switch (filter.kind) {
    case FilterKind::kBspline:
    case FilterKind::kInterpolatingBspline:
      return cubic(x, 1.0, 0.0);
    case FilterKind::kCatmullRom:
      return cubic(x, 0.0, 0.5);
    case FilterKind::kMitchell:
      return cubic(x, 1.0 / 3.0, 1.0 / 3.0);
    case FilterKind::kLanczos:
      return std::abs(x) < filter.radius ? sinc(x) * sinc(x / filter.radius) : 0.0;
    default:
      return std::abs(x) < 1.0 ? 1.0 - std::abs(x) : 0.0;
  }
}

}  // namespace

int kernel_radius(const Filter& filter) {
  if (filter.kind == FilterKind::kLinear) return 1;
  return filter.kind == FilterKind::kLanczos ? filter.radius : 2;
}

void make_weights(const Filter& filter, double fraction, double* weights) {
  const int radius = kernel_radius(filter);
  double sum = 0.0;
  for (int j = 0; j < 2 * radius; ++j) sum += weights[j] = eval_kernel(filter, fraction - (j - radius + 1));
  for (int j = 0; j < 2 * radius; ++j) weights[j] /= sum;
}

void solve_bspline(std::vector<double>& values) {
  const std::size_t count = values.size();
  if (count < 2) return;
  // Rows: c[i-1] + 4 c[i] + c[i+1] = 6 value[i]; mirrored, the first row is 4 c[0] + 2 c[1], the last alike. Eliminate
  // downwards, then insert upwards.
  std::vector<double> above(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double below_weight = i == 0 ? 0.0 : (i + 1 == count ? 2.0 : 1.0);
    const double pivot = 4.0 - (i == 0 ? 0.0 : below_weight * above[i - 1]);
    above[i] = (i == 0 ? 2.0 : 1.0) / pivot;
    values[i] = (6.0 * values[i] - (i == 0 ? 0.0 : below_weight * values[i - 1])) / pivot;
  }
  for (std::size_t i = count - 1; i-- > 0;) values[i] -= above[i] * values[i + 1];
}

}  // namespace tetravox::reference
