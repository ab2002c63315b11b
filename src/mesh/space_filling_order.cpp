#include "src/mesh/space_filling_order.h"

#include <algorithm>

namespace tetravox::mesh {
namespace {

/// Spreads the low 21 bits so that two zero bits follow each.
std::uint64_t spread_bits(std::uint64_t x) noexcept {
  x &= 0x1FFFFF;
  x = (x | x << 32) & 0x001F00000000FFFF;
  x = (x | x << 16) & 0x001F0000FF0000FF;
  x = (x | x << 8) & 0x100F00F00F00F00F;
  x = (x | x << 4) & 0x10C30C30C30C30C3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

}  // namespace

std::uint64_t hilbert_index(std::array<std::uint32_t, 3> position) noexcept {
  auto& [x, y, z] = position;
  // Undo the reflections and exchanges of axes, from the coarsest level down.
  for (std::uint32_t bit = 1u << (kHilbertBits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t low = bit - 1;
    for (std::uint32_t& axis : position) {
      const std::uint32_t reflect = axis & bit ? low : 0;
      const std::uint32_t exchange = axis & bit ? 0 : (x ^ axis) & low;
      x ^= reflect ^ exchange;
      axis ^= exchange;
    }
  }
  // Turn the digits from Gray code into numbers.
  y ^= x;
  z ^= y;
  std::uint32_t flip = 0;
  for (std::uint32_t bit = 1u << (kHilbertBits - 1); bit > 1; bit >>= 1) flip ^= z & bit ? bit - 1 : 0;
  x ^= flip;
  y ^= flip;
  z ^= flip;
  return spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
}

std::uint64_t hilbert_index(const double* point, const CurveDomain& domain) noexcept {
  constexpr double kLast = (1 << kHilbertBits) - 1;
  std::array<std::uint32_t, 3> position{};
  for (int axis = 0; axis < 3; ++axis) {
    if (domain.half_extent <= 0.0) break;
    const double part = (point[axis] * 0.5 - domain.half_min[axis]) / domain.half_extent;
    position[axis] = static_cast<std::uint32_t>(std::clamp(part * kLast, 0.0, kLast));
  }
  return hilbert_index(position);
}

}  // namespace tetravox::mesh
