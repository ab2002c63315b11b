#pragma once

/// A brick's values as the marcher wants them: small enough to stay in the cache.

#include "src/cpu/kernels/kernels.h"
#include "src/grid/values.h"
#include "tetravox/grid.h"

#include <cstdint>
#include <vector>

namespace tetravox::cpu {

/// Memory of one lattice at a time, used again and again.
class BrickLattice {
 public:
  /// Box, cells and flags of a brick whose lattice cells are 2^level cells a side; no values yet.
  MarchBrick describe(const PreparedGrid& grid, std::uint32_t brick, int level);

  /// Reads the values of the brick described last, and points `brick` at them.
  void fill(const grid::BlockReader& reader, const PreparedGrid& grid, bool is_constant, MarchBrick& brick);

 private:
  void fill_records(const MarchBrick& brick);

  grid::Block block_;
  std::int64_t stride_ = 1;
  std::vector<float> values_, records_;
};

}  // namespace tetravox::cpu
