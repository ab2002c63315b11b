#pragma once

/// A kernel's field at the nodes of a brick's lattice: fine enough to be taken as trilinear in between.

#include "src/grid/separable_kernel.h"
#include "src/grid/values.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::scene {

/// What is filtered, and how well the lattice must know it.
struct KernelField {
  const grid::BlockReader* reader = nullptr;
  std::int64_t padding = 0;  ///< places of the reader before the grid's first value
  const grid::SeparableKernel* kernel = nullptr;
  int most_parts = 8;         ///< that a cell is divided into, along each axis
  float allowed_rate = 0.0f;  ///< error in colour for one unit of world length
};

/// Parts of a cell, along each axis, for pre-classified kernels: densities are filtered channel by channel then.
inline constexpr int kDensityParts = 4;

/// Memory of one lattice at a time, used again and again.
class KernelLattice {
 public:
  /// Reads the values in reach of a brick's cells.
  void read(const KernelField& field, const grid::Block& cells);
  /// Those values, [k][j][i] of `margin_block`; may be changed before they are filtered.
  std::vector<float>& margin() { return margin_; }

  /// Nodes [z][y][x] of the cells divided into `parts` along each axis.
  void divide(const KernelField& field, int parts, std::vector<float>& nodes);
  /// The same, divided until the trilinear lattice is as near to the field as `steepness` (change of density with the
  /// scalar) asks, at least into `least_parts`. Returns into how many.
  int divide_as_asked(const KernelField& field, float steepness, int least_parts, std::vector<float>& nodes);
  /// The derivative along one axis, a cell.
  void differentiate(const KernelField& field, int parts, int axis, std::vector<float>& nodes);

 private:
  void convolve(const std::array<const std::vector<float>*, 3>& weights, int parts, std::vector<float>& nodes);
  float measure_bend(const std::vector<float>& nodes) const;

  grid::Block cells_, margin_block_;
  std::vector<float> margin_, along_x_, along_y_;
};

}  // namespace tetravox::scene
