#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tetravox::optics {

/// Ray integrals of slabs of one thickness, by the scalars in front and behind: premultiplied colour and opacity (the
/// two-dimensional table of Engel, Kraus and Ertl 2001). Scalars are rounded to nodes.
struct SlabTable {
  static constexpr int kNodes = 512;

  float first = 0.0f;                         ///< stored scalar at node 0
  float nodes_per_scalar = 1.0f;              ///< node = (stored - first) * nodes_per_scalar
  std::vector<std::array<float, 4>> entries;  ///< [front][back]

  std::size_t bytes() const { return entries.size() * sizeof(entries[0]); }
};

}  // namespace tetravox::optics
