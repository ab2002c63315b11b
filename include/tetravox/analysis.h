#pragma once

/// What a field is like: histograms of values and of gradients, and transfer functions that follow from them.

#include "tetravox/dataset.h"
#include "tetravox/grid.h"
#include "tetravox/mesh.h"
#include "tetravox/transfer_function.h"

#include <optional>
#include <vector>

namespace tetravox {

struct HistogramOptions {
  int bins = 256;                            ///< of the value, in [1, 65536]; of a `Histogram2D`, in [1, 4096]
  int gradient_bins = 256;                   ///< of the gradient magnitude, in [1, 4096]
  std::optional<ValueRange> range;           ///< empty: all values
  std::optional<ValueRange> gradient_range;  ///< value per world length; empty: from 0, without a few outliers
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

/// Shares of the volume by value and gradient magnitude, equal bins.
struct Histogram2D {
  ValueRange range;           ///< of the value
  ValueRange gradient_range;  ///< of the gradient magnitude, value per world length
  int bins = 0;
  int gradient_bins = 0;
  std::vector<double> counts;  ///< [gradient_bins][bins], the lowest gradients first
};

/// How often each value occurs with each gradient magnitude: homogeneous materials are spots at the bottom, boundaries
/// between them are arches (Kindlmann and Durkin 1998).
///
/// Meshes: at places spread evenly in the cells, gradients averaged at the vertices and linear in between. Grids:
/// central differences at the values. Above 4 million places, evenly spread ones.
/// @throws Error (kInvalidArgument) for bins or a range that make no sense.
Histogram2D make_gradient_histogram(const PreparedMesh& mesh, const HistogramOptions& options = {});
Histogram2D make_gradient_histogram(const PreparedGrid& grid, const HistogramOptions& options = {});

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
