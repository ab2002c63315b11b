#pragma once

/// The field as a separable kernel reconstructs it, for filters other than linear and nearest.

#include "src/grid/separable_kernel.h"
#include "src/grid/values.h"
#include "tetravox/grid.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tetravox::scene {

/// What a kernel needs beside the values. Empty: the filter needs none.
struct FilteredField {
  static constexpr std::int64_t kMargin = 2;  ///< places around the coefficients

  Filter filter;
  std::unique_ptr<grid::SeparableKernel> kernel;
  std::shared_ptr<const PreparedGrid> middles;  ///< cell data: the values as points at the middles of their cells
  std::vector<float> coefficients;              ///< with a margin of `kMargin` places; empty: the values serve
  std::unique_ptr<grid::BlockReader> reader;
  std::vector<float> min, max;  ///< of the filtered field in each brick
};

/// Whether a filter is drawn by a kernel.
bool wants_kernel(const Filter& filter);

/// Coefficients, reader and range in each brick. `grid` must outlive what comes back. Deterministic.
FilteredField make_filtered_field(const PreparedGrid& grid, const Filter& filter);

}  // namespace tetravox::scene
