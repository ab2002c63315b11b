#pragma once

/// Moreland and Angel's psi: the mean transparency along a segment whose extinction is linear.
///
/// Moreland, Angel 2004, "A Fast High Accuracy Volume Renderer for Unstructured Data":
///   psi(d0, d1) = integral over t in [0, 1] of exp(-(d0 t + (d1 - d0) t^2 / 2)),
/// with d0, d1 the extinctions at the two ends times the length. The colour of a segment with linear colour is then
/// exactly c0 (1 - psi) + c1 (psi - exp(-(d0 + d1) / 2)).

#include <vector>

namespace tetravox::optics {

/// 1 - psi on a square grid over gamma = d / (d + 1), bilinear in between; error below 2e-5.
struct TransparencyTable {
  static constexpr int kSize = 512;  ///< intervals a side
  std::vector<float> absorbed;       ///< [kSize + 1][kSize + 1]: row gamma of d0, column gamma of d1
};

/// 1 - psi by quadrature, to 1e-12.
double eval_absorbed(double d0, double d1);

/// The table, made once at first use. Thread safe.
const TransparencyTable& transparency_table();

}  // namespace tetravox::optics
