#pragma once

/// How fast the optics change, and whether there is anything to see, over any range of scalars, at once.

#include "src/optics/antiderivative_table.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::optics {

/// Bins over the stored scalars, and the largest value over 2^level bins from each: two look-ups answer for any range
/// (the sparse table of Bender and Farach-Colton 2000).
struct SteepnessTable {
  static constexpr int kBins = 1024;
  static constexpr int kLevels = 11;
  float first = 0.0f;  ///< stored scalar at the lower end of bin 0; beyond the ends the outermost bins hold
  float bins_per_scalar = 0.0f;
  /// [kLevels][kBins]: largest change, for one unit of stored scalar, of extinction or extinction * colour, per world
  /// length; huge at steps.
  std::vector<float> steepness;
  std::vector<float> extinction;  ///< [kLevels][kBins]: largest extinction

  /// Largest values over stored scalars in [min, max].
  float largest_steepness(float min, float max) const { return largest(steepness, min, max); }
  float largest_extinction(float min, float max) const { return largest(extinction, min, max); }

 private:
  int bin_of(float scalar) const;
  float largest(const std::vector<float>& table, float min, float max) const;
};

/// `min`, `max`: stored scalars that occur.
void build_steepness_table(const ControlPointTable& points, float min, float max, SteepnessTable& table);

}  // namespace tetravox::optics
