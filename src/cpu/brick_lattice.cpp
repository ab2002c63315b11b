#include "src/cpu/brick_lattice.h"

#include "src/grid/summaries.h"

#include <algorithm>

namespace tetravox::cpu {

MarchBrick BrickLattice::describe(const PreparedGrid& grid, std::uint32_t index, int level) {
  const auto& counts = grid.bricks.counts;
  const grid::BrickBox box = grid::box_of_brick(
      grid.data.shape, {index % counts[0], index / counts[0] % counts[1], index / counts[0] / counts[1]});
  MarchBrick brick;
  stride_ = std::int64_t{1} << level;
  for (int axis = 0; axis < 3; ++axis) {
    block_.first[axis] = box.first[axis];
    block_.count[axis] = box.count[axis];
    brick.lower[axis] = static_cast<float>(box.first[axis]);
    brick.upper[axis] = static_cast<float>(box.first[axis] + box.count[axis]);
    brick.is_last[axis] = box.first[axis] + box.count[axis] + 1 == grid.data.shape.dimensions[axis];
    brick.cells[axis] = static_cast<std::int32_t>((box.count[axis] + stride_ - 1) / stride_);
  }
  brick.has_missing = grid.bricks.has_missing[index] != 0;
  return brick;
}

void BrickLattice::fill(const grid::BlockReader& reader, const PreparedGrid& grid, bool is_constant,
                        MarchBrick& brick) {
  (void)grid;
  grid::Block block = block_;
  if (!is_constant)
    for (std::int64_t& count : block.count) ++count;
  values_.resize(static_cast<std::size_t>(block.size()));
  reader.read(block, values_.data());
  if (is_constant) {
    brick.constants = values_.data();
    return;
  }
  block_ = block;
  fill_records(brick);
  brick.records = records_.data();
}

void BrickLattice::fill_records(const MarchBrick& brick) {
  const std::int64_t nx = brick.cells[0], ny = brick.cells[1], nz = brick.cells[2];
  records_.resize(static_cast<std::size_t>(4 * nx * ny * (nz + 1)));
  const auto row_of = [&](std::int64_t j, std::int64_t k) {
    const std::int64_t y = std::min(j * stride_, block_.count[1] - 1), z = std::min(k * stride_, block_.count[2] - 1);
    return values_.data() + (z * block_.count[1] + y) * block_.count[0];
  };
  float* record = records_.data();
  const std::int64_t last = block_.count[0] - 1;
  for (std::int64_t k = 0; k <= nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j) {
      const float *low = row_of(j, k), *high = row_of(j + 1, k);
      for (std::int64_t i = 0; i < nx; ++i, record += 4) {
        const std::int64_t x = i * stride_, x_next = std::min(x + stride_, last);
        record[0] = low[x];
        record[1] = low[x_next];
        record[2] = high[x];
        record[3] = high[x_next];
      }
    }
}

}  // namespace tetravox::cpu
