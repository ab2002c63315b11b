#pragma once

/// Tables that make the integral of any segment two look-ups and a difference.
///
/// T(s) = integral of the extinction, K(s) = integral of colour times extinction, over the scalar. Along a segment
/// whose scalar runs linearly from a to b the mean extinction is (T(b) - T(a)) / (b - a), whatever the function does in
/// between (Max, Hanrahan, Crawfis 1990; Roettger, Kraus, Ertl 2000; Lum, Wilson, Ma 2004).

#include "tetravox/dataset.h"
#include "tetravox/transfer_function.h"

#include <array>
#include <cstddef>
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
/// Antiderivatives and densities are exact at the nodes; between them the density is taken as linear, and intervals
/// where that is not good enough (steps, features finer than the nodes) are marked. How we differ from the literature:
/// antiderivatives are fixed-point integers, so that differences of neighbours are exact however large T has grown; and
/// segments that are flat at the table's resolution take the mean of their two densities instead of dividing by almost
/// nothing.
struct AntiderivativeTable {
  struct Node {
    std::array<std::int32_t, 4> sums{};  ///< T, K_red, K_green, K_blue, in fixed point
    std::array<float, 4> densities{};    ///< rho, rho * red, rho * green, rho * blue, per world length
  };
  static_assert(sizeof(Node) == 32);

  std::int32_t last_node = 1;  ///< nodes are 0 ... last_node
  std::vector<Node> entries;   ///< [last_node + 1]
  /// [last_node + 1]: total variation of the visible colour up to the node, largest channel.
  std::vector<float> color_variation;
  /// [last_node + 1]: 1 where the density is not nearly linear up to the next node.
  std::vector<std::int32_t> is_coarse;
  std::vector<std::int32_t> coarse_before;  ///< [last_node + 2]: how many of the nodes below are marked so
  bool has_coarse = false;                  ///< whether any is
  /// Whether scalars may be rounded to nodes, and the densities of flat segments be taken from up to half of kFlatNodes
  /// away, without the picture changing by more than `kGentleError`.
  bool is_gentle = false;
  static constexpr std::int32_t kFlatNodes = 4;
  static constexpr double kGentleError = 1e-3;
  bool covers_data = false;          ///< whether no scalar lies beyond the ends
  float first = 0.0f;                ///< stored scalar at node 0
  float nodes_per_scalar = 1.0f;     ///< position in nodes = (stored - first) * nodes_per_scalar
  float density_per_unit = 1.0f;     ///< mean density = density_per_unit * difference of sums / difference of positions
  float units_per_density = 1.0f;    ///< its inverse
  float largest_color_slope = 0.0f;  ///< bound on the change of colour between neighbouring nodes
  std::array<float, 4> density_below{};  ///< rho, rho * colour before node 0 ...
  std::array<float, 4> density_above{};  ///< ... and after the last node

  std::size_t bytes() const {
    return entries.size() * sizeof(Node) + color_variation.size() * sizeof(float) +
           (is_coarse.size() + coarse_before.size()) * sizeof(std::int32_t);
  }
};

/// Makes `table` that of `function` over the part of `range` (values) where it varies: one pass, well under a
/// millisecond; memory of an earlier table is used again. `longest`: world length of the longest ray (the diagonal of
/// the bounds).
void build_antiderivative_table(const OpticalFunction& function, const ScalarMap& map, const ValueRange& range,
                                double longest, AntiderivativeTable& table);

/// The control points themselves, for exact evaluation: with an index that finds the interval of a scalar in a step or
/// two.
struct ControlPointTable {
  std::int32_t interval_count = 1;  ///< intervals 0 ... interval_count - 1; interval i ends where i + 1 starts
  std::vector<float> starts;        ///< [interval_count + 1] stored scalars: -inf, control points, +inf
  std::vector<std::array<float, 4>> densities_front;  ///< [interval_count] rho, red, green, blue at `references`
  std::vector<std::array<float, 4>> slopes;           ///< [interval_count] of the same, per stored scalar
  std::vector<float> references;                      ///< [interval_count] scalar at which densities_front holds
  std::vector<std::int32_t> first_interval;           ///< [buckets]: interval of the lower end of each bucket
  float first = 0.0f;
  float buckets_per_scalar = 1.0f;

  std::size_t bytes() const {
    return starts.size() * 11 * sizeof(float) + first_interval.size() * sizeof(std::int32_t);
  }
};

ControlPointTable build_control_point_table(const OpticalFunction& function, const ScalarMap& map);

/// rho, rho * red, rho * green, rho * blue at a stored scalar; NaNs for NaN.
std::array<float, 4> eval_densities(const ControlPointTable& points, float scalar);
/// The same by the line of one interval.
std::array<float, 4> eval_densities(const ControlPointTable& points, std::size_t interval, float scalar);

}  // namespace tetravox::optics
