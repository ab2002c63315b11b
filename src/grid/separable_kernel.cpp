#include "src/grid/separable_kernel.h"

#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace tetravox::grid {
namespace {

class LinearKernel final : public SeparableKernel {
 public:
  int radius() const override { return 1; }
  double eval(double x) const override { return std::max(0.0, 1.0 - std::abs(x)); }
  double eval_derivative(double x) const override { return std::abs(x) < 1.0 ? (x < 0.0 ? 1.0 : -1.0) : 0.0; }
};

/// The cubics of Mitchell and Netravali 1988, with their parameters B and C.
class CubicKernel final : public SeparableKernel {
 public:
  CubicKernel(double b, double c, bool wants_prefilter = false) : b_(b), c_(c), wants_prefilter_(wants_prefilter) {}

  int radius() const override { return 2; }
  bool wants_prefilter() const override { return wants_prefilter_; }

  double eval(double x) const override {
    const double t = std::abs(x);
    if (t < 1.0) return ((12 - 9 * b_ - 6 * c_) * t * t * t + (-18 + 12 * b_ + 6 * c_) * t * t + (6 - 2 * b_)) / 6;
    if (t < 2.0)
      return ((-b_ - 6 * c_) * t * t * t + (6 * b_ + 30 * c_) * t * t + (-12 * b_ - 48 * c_) * t + (8 * b_ + 24 * c_)) /
             6;
    return 0.0;
  }

  double eval_derivative(double x) const override {
    const double t = std::abs(x), sign = x < 0.0 ? -1.0 : 1.0;
    if (t < 1.0) return sign * (3 * (12 - 9 * b_ - 6 * c_) * t * t + 2 * (-18 + 12 * b_ + 6 * c_) * t) / 6;
    if (t < 2.0) return sign * (3 * (-b_ - 6 * c_) * t * t + 2 * (6 * b_ + 30 * c_) * t + (-12 * b_ - 48 * c_)) / 6;
    return 0.0;
  }

 private:
  double b_, c_;
  bool wants_prefilter_;
};

/// sinc(x) sinc(x / radius) (Duchon 1979).
class LanczosKernel final : public SeparableKernel {
 public:
  explicit LanczosKernel(int radius) : radius_(radius) {}

  int radius() const override { return radius_; }
  double eval(double x) const override { return std::abs(x) < radius_ ? sinc(x) * sinc(x / radius_) : 0.0; }
  double eval_derivative(double x) const override {
    if (!(std::abs(x) < radius_)) return 0.0;
    return sinc_derivative(x) * sinc(x / radius_) + sinc(x) * sinc_derivative(x / radius_) / radius_;
  }

 private:
  static double sinc(double x) {
    const double t = std::numbers::pi * x;
    return std::abs(t) < 1e-8 ? 1.0 : std::sin(t) / t;
  }
  static double sinc_derivative(double x) {
    return std::abs(x) < 1e-4 ? -std::numbers::pi * std::numbers::pi * x / 3.0
                              : (std::cos(std::numbers::pi * x) - sinc(x)) / x;
  }

  int radius_;
};

/// Filters values in place, the row being mirrored at both ends.
void prefilter_run(std::span<double> row) {
  const std::size_t count = row.size();
  if (count < 2) return;
  const double pole = std::sqrt(3.0) - 2.0;
  for (double& value : row) value *= 6.0;
  // The first causal coefficient sums the mirrored row: exactly, over its period of 2 (count - 1).
  double sum = row[0], power = pole;
  const double last_power = std::pow(pole, static_cast<double>(count - 1));
  double mirrored = last_power * last_power / pole;
  sum += last_power * row[count - 1];
  for (std::size_t i = 1; i + 1 < count; ++i, power *= pole, mirrored /= pole) sum += (power + mirrored) * row[i];
  row[0] = sum / (1.0 - last_power * last_power);
  for (std::size_t i = 1; i < count; ++i) row[i] += pole * row[i - 1];
  row[count - 1] = pole / (pole * pole - 1.0) * (row[count - 1] + pole * row[count - 2]);
  for (std::size_t i = count - 1; i > 0; --i) row[i - 1] = pole * (row[i] - row[i - 1]);
}

/// Filters one row of `count` values, `stride` apart, from missing value to missing value.
void prefilter_row(float* values, std::size_t count, std::size_t stride, std::vector<double>& run) {
  run.clear();
  for (std::size_t i = 0; i <= count; ++i) {
    const float value = i < count ? values[i * stride] : std::numeric_limits<float>::quiet_NaN();
    if (value == value) {
      run.push_back(static_cast<double>(value));
      continue;
    }
    prefilter_run(run);
    for (std::size_t k = 0; k < run.size(); ++k) values[(i - run.size() + k) * stride] = static_cast<float>(run[k]);
    run.clear();
  }
}

}  // namespace

std::unique_ptr<SeparableKernel> make_kernel(const Filter& filter) {
  switch (filter.kind) {
    case FilterKind::kNearest:
      return nullptr;
    case FilterKind::kLinear:
      return std::make_unique<LinearKernel>();
    case FilterKind::kBspline:
      return std::make_unique<CubicKernel>(1.0, 0.0);
    case FilterKind::kInterpolatingBspline:
      return std::make_unique<CubicKernel>(1.0, 0.0, true);
    case FilterKind::kCatmullRom:
      return std::make_unique<CubicKernel>(0.0, 0.5);
    case FilterKind::kMitchell:
      return std::make_unique<CubicKernel>(1.0 / 3.0, 1.0 / 3.0);
    case FilterKind::kLanczos:
      break;
  }
  return std::make_unique<LanczosKernel>(filter.radius);
}

std::vector<double> weights_at(const SeparableKernel& kernel, double phase) {
  std::vector<double> weights;
  double sum = 0.0;
  for (int i = 1 - kernel.radius(); i <= kernel.radius(); ++i) {
    weights.push_back(kernel.eval(phase - i));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double overshoot_of(const SeparableKernel& kernel) {
  constexpr int kPhases = 64;
  double largest = 1.0;
  for (int i = 0; i <= kPhases; ++i) {
    double sum = 0.0;
    for (const double weight : weights_at(kernel, static_cast<double>(i) / kPhases)) sum += std::abs(weight);
    largest = std::max(largest, sum);
  }
  return largest * largest * largest;
}

void prefilter_bspline(const std::array<std::size_t, 3>& dimensions, std::vector<float>& values) {
  const std::array<std::size_t, 3> strides{1, dimensions[0], dimensions[0] * dimensions[1]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    support::parallel_chunks(dimensions[u] * dimensions[v], 256, [&](std::size_t begin, std::size_t end) {
      std::vector<double> row;
      for (std::size_t i = begin; i < end; ++i)
        prefilter_row(values.data() + i % dimensions[u] * strides[u] + i / dimensions[u] * strides[v], dimensions[axis],
                      strides[axis], row);
    });
  }
}

}  // namespace tetravox::grid
