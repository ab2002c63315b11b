#pragma once

/// Gradients at the nodes (or cells) of a brick's lattice, in grid coordinates: stored scalar a grid unit.

#include "src/grid/frame.h"
#include "src/grid/values.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::cpu {

/// Where gradients of a brick come from.
enum class GradientSource {
  kNone,     ///< nobody asks, or the kernels take them from the corners of the cell at hand
  kCentral,  ///< central differences of the values
  kKernel    ///< derivatives of the kernel
};

/// What central differences are taken of.
struct DifferenceField {
  const grid::BlockReader* reader = nullptr;
  const grid::GridFrame* frame = nullptr;
  std::array<std::size_t, 3> value_dimensions{};
  bool is_cell = false;  ///< values lie in the middles of cells
};

/// Central differences of the values of `block`, [k][j][i][4]; one-sided at the border of the grid and beside missing
/// values, 0 where both neighbours are missing.
void find_central_gradients(const DifferenceField& field, const grid::Block& block, std::vector<float>& scratch,
                            std::vector<float>& gradients);

/// Gradients [k][j][i][4] at nodes, linear in between, at the nodes of cells divided into `parts`.
void refine_gradients(const std::array<std::int64_t, 3>& counts, int parts, const std::vector<float>& coarse,
                      std::vector<float>& fine);

/// The same, each repeated for the half cells that touch it: for cells that are constant around each value.
void spread_gradients(const std::array<std::int64_t, 3>& counts, const std::array<std::int32_t, 3>& cells,
                      const std::vector<float>& at_points, std::vector<float>& spread);

}  // namespace tetravox::cpu
