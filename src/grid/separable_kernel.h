#pragma once

/// Reconstruction filters: separable kernels, each a small object. Nothing else knows them by name.

#include "tetravox/grid.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace tetravox::grid {

/// A kernel k(x) of one axis, x in samples; zero beyond its radius. The field is the sum of values times
/// k(x - i) k(y - j) k(z - k).
class SeparableKernel {
 public:
  virtual ~SeparableKernel() = default;

  virtual int radius() const = 0;
  virtual double eval(double x) const = 0;
  virtual double eval_derivative(double x) const = 0;
  /// Whether values must be turned into coefficients first, so that the field passes through them.
  virtual bool wants_prefilter() const { return false; }
};

/// The kernel of a filter; null for nearest, which has none that is continuous.
std::unique_ptr<SeparableKernel> make_kernel(const Filter& filter);

/// Weights of the values at -radius + 1 ... radius for a place `phase` in [0, 1] after value 0. They add up to 1, so
/// that a constant field stays constant.
std::vector<double> weights_at(const SeparableKernel& kernel, double phase);

/// Largest sum of the weights' magnitudes: how far the field may leave the range of the values, 1 for not at all.
double overshoot_of(const SeparableKernel& kernel);

/// Coefficients of the cubic B-spline that passes through the values of `values` [k][j][i], in place: a recursive
/// filter along each axis with mirrored borders (Unser, Aldroubi, Eden 1991). Values that are not numbers stay;
/// the rows end there and begin anew.
void prefilter_bspline(const std::array<std::size_t, 3>& dimensions, std::vector<float>& values);

}  // namespace tetravox::grid
