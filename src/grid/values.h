#pragma once

/// Values of a grid, block by block, as stored scalars.

#include "tetravox/dataset.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetravox::grid {

/// value = offset + stored * scale.
struct ScalarFrame {
  double offset = 0.0;  ///< float can hold it
  double scale = 1.0;   ///< a power of two
};

/// The frame for values in `range`: the middle becomes 0 where the range is narrow compared with its distance from 0;
/// otherwise 0 stays 0. Stored scalars lie in about [-2, 2].
ScalarFrame choose_scalar_frame(const ValueRange& range);

/// A box of values: signed, since blocks may reach over the border of the grid.
struct Block {
  std::array<std::int64_t, 3> first{};
  std::array<std::int64_t, 3> count{};

  std::int64_t size() const { return count[0] * count[1] * count[2]; }
};

/// Reads blocks of a grid. Views the grid's values. Safe to use from many threads.
class BlockReader {
 public:
  BlockReader(const GridData& grid, const ScalarFrame& frame);

  /// Writes the stored scalars of `block` to `out`, [k][j][i]. Places beyond the border have the value of the nearest
  /// place inside; values that are not finite become NaN.
  void read(const Block& block, float* out) const;

  /// Asks for the memory of a block that will be read soon.
  void prefetch(const Block& block) const;

 private:
  using ReadRow = void (*)(const std::byte* row, int components, int component, std::int64_t count, double offset,
                           double inverse_scale, float* out);

  bool is_inside(const Block& block) const;
  const std::byte* row_of(const Block& block, std::int64_t j, std::int64_t k) const;
  void read_row(std::int64_t j, std::int64_t k, const Block& block, float* out) const;

  const std::byte* values_ = nullptr;
  std::array<std::int64_t, 3> dimensions_{};
  std::size_t value_bytes_ = 1;
  int components_ = 1, component_ = 0;
  double offset_ = 0.0, inverse_scale_ = 1.0;
  ReadRow read_row_ = nullptr;
};

}  // namespace tetravox::grid
