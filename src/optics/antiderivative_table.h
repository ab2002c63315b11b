#pragma once

/// Tables that make the integral of any segment two look-ups and a difference.
///
/// T(s) = integral of the extinction, K(s) = integral of colour times extinction, over the scalar. Along a segment
/// whose scalar runs linearly from a to b the mean extinction is (T(b) - T(a)) / (b - a), whatever the function does in
/// between (Max, Hanrahan, Crawfis 1990; Roettger, Kraus, Ertl 2000; Lum, Wilson, Ma 2004).

#include "tetravox/dataset.h"
#include "tetravox/transfer_function.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::optics {

/// value = offset + stored * scale: how a prepared dataset keeps its scalars.
struct ScalarMap {
  double offset = 0.0;
  double scale = 1.0;

  float stored_from_value(double value) const { return static_cast<float>((value - offset) / scale); }
};

/// Antiderivatives and densities at equally spaced nodes.
///
/// How we differ from the literature: the antiderivatives are fixed-point integers, so that differences of neighbouring
/// nodes are exact however large T has grown; and segments that are flat at the table's resolution read the
/// density at their middle instead of dividing by almost nothing.
struct AntiderivativeTable {
  /// T, K_red, K_green, K_blue at a node, in units of `quantum`; or rho, rho*red, rho*green, rho*blue (bits of float).
  using Entry = std::array<std::int32_t, 4>;
  static_assert(sizeof(Entry) == 16);

  /// A segment is flat where its two nodes are at most this far apart.
  static constexpr std::int32_t kFlatNodes = 4;

  std::int32_t last_node = 1;  ///< nodes are 0 ... last_node
  std::vector<Entry> entries;  ///< [2][last_node + 1]: antiderivatives, then densities
  std::vector<float>
      color_variation;  ///< [last_node + 1]: total variation of the visible colour up to the node, largest channel
  float first = 0.0f;   ///< stored scalar at node 0
  float nodes_per_scalar = 1.0f;         ///< node = (stored - first) * nodes_per_scalar, rounded
  float quantum = 1.0f;                  ///< mean extinction = quantum * difference of entries / difference of nodes
  float largest_color_slope = 0.0f;      ///< bound on the variation of colour between neighbouring nodes
  std::array<float, 4> density_below{};  ///< rho, rho*color before node 0 ...
  std::array<float, 4> density_above{};  ///< ... and after the last node
};

/// The table of `function` over the part of `range` (values) where it varies; one pass, well under a millisecond.
AntiderivativeTable build_antiderivative_table(const OpticalFunction& function, const ScalarMap& map,
                                               const ValueRange& range);

/// The control points themselves, for exact evaluation: with an index that finds the interval of a scalar in a step or
/// two.
struct ControlPointTable {
  std::int32_t interval_count = 1;  ///< intervals 0 ... interval_count - 1; interval i ends where i + 1 starts
  std::vector<float> starts;        ///< [interval_count + 1] stored scalars: -inf, control points, +inf
  std::vector<std::array<float, 4>>
      densities_front;                       ///< [interval_count] rho, red, green, blue at the start of the interval
  std::vector<std::array<float, 4>> slopes;  ///< [interval_count] of the same, per stored scalar
  std::vector<float> references;             ///< [interval_count] scalar at which densities_front holds
  std::vector<std::int32_t> first_interval;  ///< [buckets]: interval of the lower end of each bucket
  float first = 0.0f;
  float buckets_per_scalar = 1.0f;
};

ControlPointTable build_control_point_table(const OpticalFunction& function, const ScalarMap& map);

}  // namespace tetravox::optics
