#pragma once

/// Sums that stand for integrals: the ten-point Gauss-Legendre rule, and emission behind absorption by it, halved until
/// nothing changes.

#include "tests/reference/segment.h"

#include <array>
#include <cmath>

namespace tetravox::reference {

inline constexpr int kNodeCount = 10;

/// Nodes and weights on [0, 1], ascending.
struct GaussRule {
  std::array<double, kNodeCount> node{}, weight{};
  /// [i][j]: integral of the j-th Lagrange polynomial over [0, node[i]]: what has gathered on the way to a node.
  std::array<std::array<double, kNodeCount>, kNodeCount> gathered{};
};
const GaussRule& gauss_rule();

/// What glows and absorbs at one place, per world length.
struct Density {
  double extinction = 0.0;
  Color emission{};  ///< extinction times colour
};

/// Emission and depth of a stretch alone, as if nothing lay in front of it.
struct StretchIntegral {
  Color color{};
  double optical_depth = 0.0;
};

/// One application of the rule to the stretch [u0, u1]; `density_at(u)` in world lengths of `length` for u in [0, 1].
template <class DensityAt>
StretchIntegral apply_rule(const DensityAt& density_at, double u0, double u1, double length) {
  const GaussRule& rule = gauss_rule();
  const double step = (u1 - u0) * length;
  std::array<Density, kNodeCount> density;
  for (int i = 0; i < kNodeCount; ++i) density[i] = density_at(u0 + (u1 - u0) * rule.node[i]);
  StretchIntegral result;
  for (int i = 0; i < kNodeCount; ++i) {
    double depth = 0.0;
    for (int j = 0; j < kNodeCount; ++j) depth += rule.gathered[i][j] * density[j].extinction;
    const double weight = rule.weight[i] * step * std::exp(-depth * step);
    for (int k = 0; k < 3; ++k) result.color[k] += weight * density[i].emission[k];
    result.optical_depth += rule.weight[i] * step * density[i].extinction;
  }
  return result;
}

/// Adds the stretch [u0, u1] behind what `ray` holds, halving it until both halves together say the same as the whole
/// to within 1e-11, and no part is deeper than one. `whole` is the rule's answer for the stretch.
template <class DensityAt>
void append_stretch(const DensityAt& density_at, double u0, double u1, double length, const StretchIntegral& whole,
                    int halvings, RayIntegral& ray) {
  if (ray.optical_depth >= kOpaque) return;
  const double middle = 0.5 * (u0 + u1), light = std::exp(-ray.optical_depth);
  const StretchIntegral first = apply_rule(density_at, u0, middle, length);
  const StretchIntegral second = apply_rule(density_at, middle, u1, length);
  const double passed = std::exp(-first.optical_depth);
  double change = std::abs(first.optical_depth + second.optical_depth - whole.optical_depth);
  for (int k = 0; k < 3; ++k)
    change = std::max(change, std::abs(first.color[k] + passed * second.color[k] - whole.color[k]));
  constexpr int kMostHalvings = 50;
  if (halvings < kMostHalvings && (change * light > 1e-11 || whole.optical_depth > 1.0)) {
    append_stretch(density_at, u0, middle, length, first, halvings + 1, ray);
    append_stretch(density_at, middle, u1, length, second, halvings + 1, ray);
    return;
  }
  for (int k = 0; k < 3; ++k) ray.color[k] += light * (first.color[k] + passed * second.color[k]);
  ray.optical_depth += first.optical_depth + second.optical_depth;
}

template <class DensityAt>
void append_stretch(const DensityAt& density_at, double u0, double u1, double length, RayIntegral& ray) {
  append_stretch(density_at, u0, u1, length, apply_rule(density_at, u0, u1, length), 0, ray);
}

}  // namespace tetravox::reference
