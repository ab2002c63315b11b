#pragma once

/// Value and derivatives of a field at many places: what histograms of gradients and boundary functions are made of.

#include "tetravox/grid.h"
#include "tetravox/mesh.h"

#include <cstddef>
#include <vector>

namespace tetravox::scene {

/// The field at one place. Lengths are in units of `DifferentialSamples::unit_length`.
struct DifferentialSample {
  float value = 0.0f;     ///< stored scalar, as it is drawn
  float gradient = 0.0f;  ///< magnitude, stored scalar per length
  float second = 0.0f;    ///< second derivative along the gradient, stored scalar per length squared
  float volume = 0.0f;    ///< around the place, in any one unit; 0: no such place
};

struct DifferentialSamples {
  std::vector<DifferentialSample> samples;
  std::vector<std::vector<float>> others;  ///< [others][samples]: stored scalars of further fields at the same places
  double unit_length = 1.0;                ///< world length
};

/// More places than this are not looked at.
inline constexpr std::size_t kLargestDifferentialCount = 4'000'000;

/// From 4 to 64 places in each cell, evenly spread; in every n-th cell of a mesh too large for that. The gradients of
/// the vertices are linear in between; their change along themselves is the second derivative. With cell data these are
/// the derivatives of the field that is linear between means at the vertices, the value is the cell's.
/// In parallel; the same for any number of threads.
DifferentialSamples sample_differentials(const PreparedMesh& mesh, std::size_t largest_count);

/// At the values, all of them or of rows evenly spread: central differences (one-sided at the border), and the second
/// derivative from the Hessian of second differences (Kindlmann and Durkin 1998, their measure by the Hessian), in
/// world directions, of even and uneven axes. Places next to a missing value, and those without a value of
/// another field, are left out.
DifferentialSamples sample_differentials(const PreparedGrid& grid, std::size_t largest_count);

/// From 0 to the largest gradient, without a few outliers; stored scalar per unit length.
ValueRange range_of_gradients(const std::vector<DifferentialSample>& samples);

}  // namespace tetravox::scene
