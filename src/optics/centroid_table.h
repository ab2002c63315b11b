#pragma once

/// Where in a segment its emission lies, and how widely: moments of the extinction over the scalar.
///
/// Along a segment the scalar is linear, so that the mean place of its extinction is that of its mean scalar,
/// (M(b) - M(a)) / (T(b) - T(a)) with T the antiderivative of rho(s) and M that of s rho(s); likewise the mean square.

#include "src/optics/antiderivative_table.h"

#include <cstdint>
#include <vector>

namespace tetravox::optics {

struct CentroidTable {
  float first = 0.0f;  ///< stored scalar of node 0
  float nodes_per_scalar = 0.0f;
  std::int32_t last_node = 0;
  /// [last_node + 1][4]: T, M, and the antiderivative of s^2 rho(s), with the scalar counted from 0 at the first node
  /// to 1 at the last, in one fixed-point unit; the bits of a float: AntiderivativeTable::color_variation.
  std::vector<std::int32_t> sums;
};

/// From the antiderivatives of the same function.
void build_centroid_table(const AntiderivativeTable& antiderivative, CentroidTable& table);

}  // namespace tetravox::optics
