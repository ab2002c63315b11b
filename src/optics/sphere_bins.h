#pragma once

/// An environment gathered in bins of about equal size over the sphere: as fine as a filter needs it, no finer.

#include "tetravox/environment.h"

#include <array>
#include <cstddef>
#include <vector>

namespace tetravox::optics {

/// What shines from a part of the sphere, as if it came from one direction: where its light has its centre, so that a
/// filter errs by the square of the part's size only, and not at all for a single small light.
struct Glow {
  /// Radiance times solid angle (in any unit): red, green, blue, and of a radiance of 1, by which filters are
  /// normalised.
  std::array<float, 4> flux{};
  std::array<float, 3> direction{};  ///< unit vector; while gathering: sum of directions times red, green and blue flux
  float padding = 0.0f;
};

/// Bins in rows from up to down; in a row evenly spaced from behind over left, ahead and right.
struct SphereBins {
  std::vector<int> columns;         ///< of each row
  std::vector<std::size_t> starts;  ///< [rows + 1]: the first bin of each row
  std::vector<double> heights;      ///< of each row's middle: cosine of its angle with up
  std::vector<Glow> bins;

  std::size_t row_count() const { return columns.size(); }
};

/// `spacing`: angle from bin to bin, about. The same bytes for any number of threads.
SphereBins gather_environment(const Environment& environment, double spacing);

}  // namespace tetravox::optics
