#pragma once

/// Positions -> places along a Hilbert curve, so that what is near in space is near in memory.

#include <array>
#include <cstdint>

namespace tetravox::mesh {

/// Bits a coordinate of the curve's lattice.
inline constexpr int kHilbertBits = 21;

/// Place of a lattice point, coordinates below 2^21, along the Hilbert curve through the lattice; neighbours along the
/// curve are neighbours in the lattice. Source: Skilling, "Programming the Hilbert curve", 2004.
std::uint64_t hilbert_index(std::array<std::uint32_t, 3> position) noexcept;

/// The cube that a curve fills.
struct CurveDomain {
  std::array<double, 3> half_min{};  ///< lower corner / 2: halves, so that no difference overflows
  double half_extent = 0.0;          ///< edge length / 2
};

/// Place of a point inside `domain` along its curve.
std::uint64_t hilbert_index(const double* point, const CurveDomain& domain) noexcept;

}  // namespace tetravox::mesh
