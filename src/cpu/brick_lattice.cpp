#include "src/cpu/brick_lattice.h"

#include "src/grid/summaries.h"

#include <algorithm>
#include <cmath>

namespace tetravox::cpu {
namespace {

/// Weights for each of `parts` places in a cell, [parts][2 * radius].
std::vector<float> weight_table(const grid::SeparableKernel& kernel, int parts) {
  std::vector<float> table;
  for (int part = 0; part < parts; ++part)
    for (const double weight : grid::weights_at(kernel, static_cast<double>(part) / parts))
      table.push_back(static_cast<float>(weight));
  return table;
}

/// Convolves rows of `in` along one axis: `count` places `stride` apart become (cells * parts + 1). The other places of
/// the block are [outer][inner], `inner` adjacent ones at a time.
struct Convolution {
  std::int64_t outer, count, inner;
  std::int64_t cells;
  int parts, taps;
};
void convolve_axis(const Convolution& c, const std::vector<float>& weights, const std::vector<float>& in,
                   std::vector<float>& out) {
  const std::int64_t nodes = c.cells * c.parts + 1;
  out.assign(static_cast<std::size_t>(c.outer * nodes * c.inner), 0.0f);
  for (std::int64_t o = 0; o < c.outer; ++o)
    for (std::int64_t node = 0; node < nodes; ++node) {
      const float* weight = weights.data() + node % c.parts * c.taps;
      float* to = out.data() + (o * nodes + node) * c.inner;
      for (int tap = 0; tap < c.taps; ++tap) {
        const float* from = in.data() + (o * c.count + node / c.parts + tap) * c.inner;
        for (std::int64_t i = 0; i < c.inner; ++i) to[i] += weight[tap] * from[i];
      }
    }
}

}  // namespace

MarchBrick BrickLattice::describe(const PreparedGrid& grid, const grid::GridFrame& frame, std::uint32_t index,
                                  int level) {
  const auto& counts = grid.bricks.counts;
  const grid::BrickBox box = grid::box_of_brick(
      grid.data.shape, {index % counts[0], index / counts[0] % counts[1], index / counts[0] / counts[1]});
  MarchBrick brick;
  stride_ = std::int64_t{1} << level;
  for (int axis = 0; axis < 3; ++axis) {
    block_.first[axis] = box.first[axis];
    block_.count[axis] = box.count[axis];
    brick.lower[axis] = frame.plane(axis, box.first[axis]);
    brick.upper[axis] = frame.plane(axis, box.first[axis] + box.count[axis]);
    brick.is_uneven |= !frame.planes[axis].empty();
    brick.is_last[axis] = box.first[axis] + box.count[axis] + 1 == grid.data.shape.dimensions[axis];
    brick.cells[axis] = static_cast<std::int32_t>((box.count[axis] + stride_ - 1) / stride_);
  }
  if (brick.is_uneven) {
    for (int axis = 0; axis < 3; ++axis) {
      cell_planes_[axis].clear();
      for (std::int64_t i = 0; i <= brick.cells[axis]; ++i)
        cell_planes_[axis].push_back(frame.plane(axis, box.first[axis] + std::min(i * stride_, box.count[axis])));
    }
    place_planes(brick, 1);
  }
  brick.has_missing = grid.bricks.has_missing[index] != 0;
  return brick;
}

void BrickLattice::fill(const LatticeField& field, MarchBrick& brick) {
  if (field.kernel) {
    filter_values(field, brick);
  } else {
    if (!field.is_constant || field.is_nearest)
      for (std::int64_t& count : block_.count) ++count;
    values_.resize(static_cast<std::size_t>(block_.size()));
    field.reader->read(block_, values_.data());
  }
  if (field.is_nearest) spread_values(brick);
  if (field.is_constant) {
    brick.constants = values_.data();
  } else if (field.points) {
    fill_densities(*field.points, brick);
    brick.densities = records_.data();
  } else {
    fill_records(brick);
    brick.records = records_.data();
  }
}

/// Planes of an uneven brick whose cells are divided into `parts`.
void BrickLattice::place_planes(MarchBrick& brick, int parts) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float>& cells = cell_planes_[axis];
    planes_[axis].clear();
    for (std::size_t i = 0; i + 1 < cells.size(); ++i)
      for (int part = 0; part < parts; ++part)
        planes_[axis].push_back(cells[i] +
                                (cells[i + 1] - cells[i]) * static_cast<float>(part) / static_cast<float>(parts));
    planes_[axis].push_back(cells.back());
    brick.planes[axis] = planes_[axis].data();
  }
}

/// Halves each cell along each axis: half a cell has the value of the point that it touches.
void BrickLattice::spread_values(MarchBrick& brick) {
  margin_.swap(values_);
  values_.clear();
  for (std::int32_t& cells : brick.cells) cells *= 2;
  if (brick.is_uneven) place_planes(brick, 2);
  for (std::int64_t k = 0; k < brick.cells[2]; ++k)
    for (std::int64_t j = 0; j < brick.cells[1]; ++j)
      for (std::int64_t i = 0; i < brick.cells[0]; ++i)
        values_.push_back(margin_[static_cast<std::size_t>(
            ((k + 1) / 2 * block_.count[1] + (j + 1) / 2) * block_.count[0] + (i + 1) / 2)]);
}

void BrickLattice::filter_values(const LatticeField& field, MarchBrick& brick) {
  const int radius = field.kernel->radius();
  for (int axis = 0; axis < 3; ++axis) {
    margin_block_.first[axis] = block_.first[axis] - radius + 1 + field.padding;
    margin_block_.count[axis] = block_.count[axis] + 2 * radius;
  }
  margin_.resize(static_cast<std::size_t>(margin_block_.size()));
  field.reader->read(margin_block_, margin_.data());
  const grid::Block cells = block_;
  const auto divide = [&](int parts) {
    for (int axis = 0; axis < 3; ++axis) {
      block_.count[axis] = cells.count[axis] * parts + 1;
      brick.cells[axis] = static_cast<std::int32_t>(cells.count[axis] * parts);
    }
    if (brick.is_uneven) place_planes(brick, parts);
    const grid::Block nodes = block_;
    block_ = cells;
    convolve(*field.kernel, parts, values_);
    block_ = nodes;
  };
  divide(1);
  // The distance of a smooth field from its lattice falls with the square of the number of parts.
  const float rate = measure_bend(values_) * brick.steepness;
  int parts = 1;
  while (parts < kMostParts && rate > field.allowed_rate * static_cast<float>(parts * parts)) parts *= 2;
  if (parts > 1) divide(parts);
}

void BrickLattice::convolve(const grid::SeparableKernel& kernel, int parts, std::vector<float>& nodes) {
  const std::vector<float> weights = weight_table(kernel, parts);
  const int taps = 2 * kernel.radius();
  const auto& in = margin_block_.count;
  const std::int64_t nx = block_.count[0] * parts + 1, ny = block_.count[1] * parts + 1;
  convolve_axis({in[2] * in[1], in[0], 1, block_.count[0], parts, taps}, weights, margin_, along_x_);
  convolve_axis({in[2], in[1], nx, block_.count[1], parts, taps}, weights, along_x_, along_y_);
  convolve_axis({1, in[2], nx * ny, block_.count[2], parts, taps}, weights, along_y_, nodes);
}

/// Bound on the distance of a field from the lattice of its nodes, by second differences.
float BrickLattice::measure_bend(const std::vector<float>& nodes) const {
  const std::array<std::int64_t, 3> strides{1, block_.count[0], block_.count[0] * block_.count[1]};
  float bend = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t along = strides[axis], size = block_.size();
    float largest = 0.0f;
    for (std::int64_t i = along; i + along < size; ++i) {
      const std::int64_t at = i / along % block_.count[axis];
      if (at == 0 || at + 1 == block_.count[axis]) continue;
      largest = std::max(
          largest, std::abs(nodes[static_cast<std::size_t>(i - along)] - 2.0f * nodes[static_cast<std::size_t>(i)] +
                            nodes[static_cast<std::size_t>(i + along)]));
    }
    bend += 0.125f * largest;
  }
  return bend;
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

void BrickLattice::fill_densities(const optics::ControlPointTable& points, const MarchBrick& brick) {
  const std::int64_t row = brick.cells[0] + 1, slice = row * (brick.cells[1] + 1);
  // A ray at the very end of the brick may look at the nodes beyond.
  records_.assign(4 * (values_.size() + static_cast<std::size_t>(slice + row + 1)), 0.0f);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const std::array<float, 4> densities = optics::eval_densities(points, values_[i]);
    std::copy(densities.begin(), densities.end(), records_.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
}

}  // namespace tetravox::cpu
