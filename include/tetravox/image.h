#pragma once

/// Pictures in memory.

#include <cstddef>
#include <vector>

namespace tetravox {

/// Premultiplied RGBA, float, row 0 at the top, pixels in rows. Colours as displayed (not linear light).
struct Image {
  int width = 0;
  int height = 0;
  std::vector<float> pixels;  ///< [height][width][4]
  /// [height][width], or empty: distance from the eye's plane along the view, world length, of the front-most surface,
  /// or of where opacity passes 0.5; infinite where neither is met.
  std::vector<float> depth = {};

  const float* pixel(int x, int y) const { return pixels.data() + 4 * (static_cast<std::size_t>(y) * width + x); }
  float* pixel(int x, int y) { return pixels.data() + 4 * (static_cast<std::size_t>(y) * width + x); }
};

}  // namespace tetravox
