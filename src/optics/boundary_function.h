#pragma once

/// A transfer function that shows boundaries between materials (Kindlmann and Durkin 1998, sections 5 and 6).

#include "tetravox/transfer_function.h"

#include <optional>
#include <vector>

namespace tetravox::optics {

/// What the places with one value have in common, in equal bins over `range`: the volume they take, and their first and
/// second derivatives along the gradient, each times that volume. Lengths in any unit.
struct DerivativeProfile {
  ValueRange range;
  std::vector<double> volumes, first, second;  ///< [bins]
};

/// Distance of a value from the middle of a boundary.
struct BoundaryPositions {
  double sigma = 0.0;             ///< blur of the boundaries: they are steps convolved with this Gaussian; length
  std::vector<double> positions;  ///< [bins], p(v) in units of sigma; infinite where no boundary is
};

/// With mean first and second derivatives g(v), h(v): sigma = 2 sqrt(e) max(g) / (max(h) - min(h)), and
/// p(v) = -sigma h(v) / max(g(v) - g_threshold, 0) in units of sigma. As in the paper, but the means are
/// smoothed over neighbouring bins, and the largest and smallest are those without the hundredth of the area of all
/// iso-surfaces (the sum of first derivatives) that is beyond.
BoundaryPositions find_boundary_positions(const DerivativeProfile& profile);

/// How a function is made of a profile.
struct BoundaryShape {
  double thickness = 0.3;  ///< standard deviation of the opacity over p, in units of sigma
  bool invert = false;
  std::optional<double> unit_distance;
  std::optional<ValueRange> background;  ///< takes no part in how much opacity there is to give away
};

/// Opacity exp(-(p(v) / thickness)^2 / 2), scaled so that a ray through everything is neither clear nor solid
/// (thicker where next to nothing would be seen); colours as those of the default function, spread over what is opaque.
TransferFunction make_boundary_function(const DerivativeProfile& profile, const BoundaryShape& shape);

}  // namespace tetravox::optics
