#pragma once

/// What a field is like: histograms of values and of gradients, and transfer functions that follow from them.

#include "tetravox/dataset.h"
#include "tetravox/grid.h"
#include "tetravox/mesh.h"
#include "tetravox/multidimensional.h"
#include "tetravox/transfer_function.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace tetravox {

struct HistogramOptions {
  int bins = 256;                   ///< of the value, in [1, 65536]; of a `Histogram2D`, in [1, 4096]
  int other_bins = 256;             ///< of the second axis of a `Histogram2D`, in [1, 4096]
  std::optional<ValueRange> range;  ///< empty: all values
  std::optional<ValueRange>
      other_range;  ///< of the second axis; empty: all, of gradients from 0 without a few outliers
};

/// The share of the volume that each bin of the value holds; all bins add up to 1 where nothing lies outside `range`.
/// The last bin holds its upper end. Without `unit_distance` and `background`.
///
/// Meshes: exact. Each cell is cut at the bins' ends, its field being linear (point data) or constant (cell data).
/// Grids: of all values, weighted by the volume of their cells where axes are uneven. The same on every run, for any
/// number of threads, as is everything below.
/// @throws Error (kInvalidArgument) for bins or a range that make no sense.
Histogram make_value_histogram(const PreparedMesh& mesh, const HistogramOptions& options = {});
Histogram make_value_histogram(const PreparedGrid& grid, const HistogramOptions& options = {});

/// Shares of the volume by value and something else: the gradient magnitude, or the value of another array. Equal bins.
struct Histogram2D {
  ValueRange range;        ///< of the value
  ValueRange other_range;  ///< of the gradient magnitude, value per world length, or of the other array
  int bins = 0;
  int other_bins = 0;
  std::vector<double> counts;  ///< [other_bins][bins], the lowest of the second axis first
};

/// How often each value occurs with each gradient magnitude: homogeneous materials are spots at the bottom, boundaries
/// between them are arches (Kindlmann and Durkin 1998).
///
/// Meshes: at places spread evenly in the cells, gradients averaged at the vertices and linear in between. Grids:
/// central differences at the values. Above 4 million places, evenly spread ones.
/// @throws Error (kInvalidArgument) for bins or a range that make no sense.
Histogram2D make_gradient_histogram(const PreparedMesh& mesh, const HistogramOptions& options = {});
Histogram2D make_gradient_histogram(const PreparedGrid& grid, const HistogramOptions& options = {});

/// How often each value occurs with each value of another array, `PreparedMesh::others[other]`; likewise of a grid. At
/// the same places as above.
/// @throws Error (kInvalidArgument) as above, and where there is no such array.
Histogram2D make_joint_histogram(const PreparedMesh& mesh, std::size_t other, const HistogramOptions& options = {});
Histogram2D make_joint_histogram(const PreparedGrid& grid, std::size_t other, const HistogramOptions& options = {});

/// The range of each variable, [variables]: its own, or what occurs: all values; of gradient magnitudes what is left
/// without a few outliers, from 0. Variables of kArray take `PreparedMesh::others` in turn, from the first.
/// @throws Error (kInvalidArgument) where there are fewer others than that.
std::vector<ValueRange> make_variable_ranges(const PreparedMesh& mesh, const std::vector<Variable>& variables);
std::vector<ValueRange> make_variable_ranges(const PreparedGrid& grid, const std::vector<Variable>& variables);

/// The function of several variables drawn when nobody gave one, as Gaussians side by side: dense where gradients are
/// large (boundaries of materials; Kindlmann and Durkin 1998), rare values denser than frequent ones; colours follow
/// the first other array, or else the value. Variables as above; they come back with
/// their ranges.
MultidimensionalFunction make_default_multidimensional(const PreparedMesh& mesh,
                                                       const std::vector<Variable>& variables);
MultidimensionalFunction make_default_multidimensional(const PreparedGrid& grid,
                                                       const std::vector<Variable>& variables);

struct BoundaryOptions {
  std::optional<ValueRange> range;  ///< values to look at; empty: all, without a few outliers
  double thickness = 0.3;           ///< of what is drawn, relative to the blur of the boundaries; in [0.05, 5]
  bool invert = false;              ///< colours the other way round
};

/// A function that is opaque where values lie in the middle between two materials, and clear inside them (Kindlmann and
/// Durkin 1998; docs/methods/transfer_functions.md). With opacities.
/// @throws Error (kInvalidArgument) for options out of range.
TransferFunction make_boundary_transfer_function(const PreparedMesh& mesh, const BoundaryOptions& options = {});
TransferFunction make_boundary_transfer_function(const PreparedGrid& grid, const BoundaryOptions& options = {});

}  // namespace tetravox
