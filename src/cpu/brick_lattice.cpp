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

/// The same for the derivative.
std::vector<float> derivative_table(const grid::SeparableKernel& kernel, int parts) {
  const int radius = kernel.radius();
  std::vector<float> table;
  for (int part = 0; part < parts; ++part) {
    const double phase = static_cast<double>(part) / parts;
    for (int i = 1 - radius; i <= radius; ++i) table.push_back(static_cast<float>(kernel.eval_derivative(phase - i)));
  }
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
        if (weight[tap] == 0.0f) continue;  // a missing value out of reach is none
        const float* from = in.data() + (o * c.count + node / c.parts + tap) * c.inner;
        for (std::int64_t i = 0; i < c.inner; ++i) to[i] += weight[tap] * from[i];
      }
    }
}

grid::BrickBox box_of(const PreparedGrid& grid, std::uint32_t brick) {
  const auto& counts = grid.bricks.counts;
  return grid::box_of_brick(grid.data.shape,
                            {brick % counts[0], brick / counts[0] % counts[1], brick / counts[0] / counts[1]});
}

/// Largest second difference along an axis of nodes [z][y][x].
float largest_bend(const std::vector<float>& nodes, const std::array<std::int64_t, 3>& counts, int axis) {
  const std::array<std::int64_t, 3> strides{1, counts[0], counts[0] * counts[1]};
  const std::int64_t along = strides[axis], size = counts[0] * counts[1] * counts[2];
  float largest = 0.0f;
  for (std::int64_t i = along; i + along < size; ++i) {
    const std::int64_t at = i / along % counts[axis];
    if (at == 0 || at + 1 == counts[axis]) continue;
    largest = std::max(largest,
                       std::abs(nodes[static_cast<std::size_t>(i - along)] - 2.0f * nodes[static_cast<std::size_t>(i)] +
                                nodes[static_cast<std::size_t>(i + along)]));
  }
  return largest;
}

/// Nodes behind the last one that a ray at the very end of the brick may look at.
std::size_t nodes_beyond(const MarchBrick& brick) {
  const auto row = static_cast<std::size_t>(brick.cells[0]) + 1;
  return row * (static_cast<std::size_t>(brick.cells[1]) + 1) + row + 1;
}

}  // namespace

void BrickLattice::prefetch(const LatticeField& field, const PreparedGrid& grid, std::uint32_t brick) {
  const grid::BrickBox box = box_of(grid, brick);
  grid::Block block{box.first, box.count};
  for (std::int64_t& first : block.first) first += field.padding;
  field.reader->prefetch(block);
}

MarchBrick BrickLattice::describe(const PreparedGrid& grid, const grid::GridFrame& frame, std::uint32_t index,
                                  int level) {
  const grid::BrickBox box = box_of(grid, index);
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

int BrickLattice::fill(const LatticeField& field, MarchBrick& brick, int least_parts) {
  if (field.kernel && field.points) {
    filter_densities(field, brick);
    brick.densities = records_.data();
    return 1;
  }
  grid::Block values = block_;
  if (!field.is_constant || field.is_nearest)
    for (std::int64_t& count : values.count) ++count;
  int parts = 1;
  if (field.kernel) {
    parts = filter_values(field, brick, least_parts);
  } else {
    block_ = values;
    values_.resize(static_cast<std::size_t>(block_.size()));
    field.reader->read(block_, values_.data());
  }
  if (field.is_nearest) spread_values(brick);
  if (field.gradients != GradientSource::kNone) fill_gradients(field, values, parts, brick);
  if (field.is_constant) {
    brick.constants = values_.data();
  } else if (field.points) {
    fill_densities(*field.points, brick);
    brick.densities = records_.data();
  } else {
    fill_records(*field.kernels, brick);
    brick.records = records_.data();
  }
  return parts;
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

/// Reads what the kernel reaches from the brick.
void BrickLattice::read_margin(const LatticeField& field) {
  const int radius = field.kernel->radius();
  for (int axis = 0; axis < 3; ++axis) {
    margin_block_.first[axis] = block_.first[axis] - radius + 1 + field.padding;
    margin_block_.count[axis] = block_.count[axis] + 2 * radius;
  }
  margin_.resize(static_cast<std::size_t>(margin_block_.size()));
  field.reader->read(margin_block_, margin_.data());
}

/// Convolves the margin; the cells of the brick are divided into `parts` along each axis.
void BrickLattice::divide_cells(const LatticeField& field, int parts, MarchBrick& brick) {
  for (int axis = 0; axis < 3; ++axis) brick.cells[axis] = static_cast<std::int32_t>(block_.count[axis] * parts);
  if (brick.is_uneven) place_planes(brick, parts);
  const std::vector<float> weights = weight_table(*field.kernel, parts);
  convolve({&weights, &weights, &weights}, parts, values_);
}

/// Returns into how many parts the cells are divided.
int BrickLattice::filter_values(const LatticeField& field, MarchBrick& brick, int least_parts) {
  read_margin(field);
  divide_cells(field, 1, brick);
  // The distance of a smooth field from its lattice falls with the square of the number of parts. It has the same sign
  // for many cells on end, so that it adds up where chords' errors do not.
  constexpr float kAddsUp = 4.0f;
  const float rate = kAddsUp * measure_bend(brick) * brick.steepness;
  int parts = std::max(brick.has_missing ? 2 : 1, least_parts);  // in the middle of a cell everything in reach counts
  while (parts < field.most_parts && rate > field.allowed_rate * static_cast<float>(parts * parts)) parts *= 2;
  if (parts > 1) divide_cells(field, parts, brick);
  if (field.gradients == GradientSource::kKernel) filter_gradients(field, parts, brick);
  for (int axis = 0; axis < 3; ++axis) block_.count[axis] = brick.cells[axis] + 1;
  return parts;
}

/// Gradients at the nodes of the lattice: the derivative along one axis, the kernel itself along the others.
void BrickLattice::filter_gradients(const LatticeField& field, int parts, const MarchBrick& brick) {
  const std::vector<float> weights = weight_table(*field.kernel, parts);
  const std::vector<float> slopes = derivative_table(*field.kernel, parts);
  for (int axis = 0; axis < 3; ++axis) {
    const auto weights_of = [&](int i) -> const std::vector<float>& { return i == axis ? slopes : weights; };
    convolve({&weights_of(0), &weights_of(1), &weights_of(2)}, parts, coarse_gradients_);
    gradients_.resize(4 * coarse_gradients_.size());
    for (std::size_t i = 0; i < coarse_gradients_.size(); ++i) gradients_[4 * i + axis] = coarse_gradients_[i];
    if (brick.is_uneven) rescale_gradients(axis, parts);
  }
}

/// From differences a cell to differences a grid unit, where cells are not one grid unit long.
void BrickLattice::rescale_gradients(int axis, int parts) {
  const std::vector<float>& planes = cell_planes_[axis];
  std::array<std::int64_t, 3> nodes{};
  for (int i = 0; i < 3; ++i) nodes[i] = block_.count[i] * parts + 1;
  const std::array<std::int64_t, 3> strides{1, nodes[0], nodes[0] * nodes[1]};
  for (std::int64_t i = 0; i < nodes[0] * nodes[1] * nodes[2]; ++i) {
    const auto cell =
        static_cast<std::size_t>(std::min(i / strides[axis] % nodes[axis] / parts, block_.count[axis] - 1));
    gradients_[4 * static_cast<std::size_t>(i) + axis] /= planes[cell + 1] - planes[cell];
  }
}

/// `values`: the values that the lattice lies between.
void BrickLattice::fill_gradients(const LatticeField& field, const grid::Block& values, int parts, MarchBrick& brick) {
  if (field.gradients == GradientSource::kCentral) {
    find_central_gradients(field.differences, values, margin_,
                           parts > 1 || field.is_nearest ? coarse_gradients_ : gradients_);
    if (parts > 1) refine_gradients(values.count, parts, coarse_gradients_, gradients_);
    if (field.is_nearest)
      spread_gradients(values.count, {brick.cells[0], brick.cells[1], brick.cells[2]}, coarse_gradients_, gradients_);
  }
  gradients_.resize(gradients_.size() + 4 * nodes_beyond(brick));
  brick.gradients = gradients_.data();
}

/// Pre-classification with a kernel: it is the densities of the values that are filtered, channel by channel.
void BrickLattice::filter_densities(const LatticeField& field, MarchBrick& brick) {
  constexpr int kParts = 4;
  read_margin(field);
  const std::vector<float> scalars = margin_;
  for (std::size_t channel = 0; channel < 4; ++channel) {
    for (std::size_t i = 0; i < scalars.size(); ++i)
      margin_[i] = optics::eval_densities(*field.points, scalars[i])[channel];
    divide_cells(field, kParts, brick);
    if (channel == 0) records_.assign(4 * (values_.size() + nodes_beyond(brick)), 0.0f);
    for (std::size_t i = 0; i < values_.size(); ++i) records_[4 * i + channel] = values_[i];
  }
}

/// `weights`: for each axis, [parts][taps].
void BrickLattice::convolve(const std::array<const std::vector<float>*, 3>& weights, int parts,
                            std::vector<float>& nodes) {
  const int taps = static_cast<int>(weights[0]->size()) / parts;
  const auto& in = margin_block_.count;
  const std::int64_t nx = block_.count[0] * parts + 1, ny = block_.count[1] * parts + 1;
  convolve_axis({in[2] * in[1], in[0], 1, block_.count[0], parts, taps}, *weights[0], margin_, along_x_);
  convolve_axis({in[2], in[1], nx, block_.count[1], parts, taps}, *weights[1], along_x_, along_y_);
  convolve_axis({1, in[2], nx * ny, block_.count[2], parts, taps}, *weights[2], along_y_, nodes);
}

/// Estimate of the distance of a field from the lattice of its nodes, by second differences: of the nodes, or of the
/// values in reach along an axis with too few of them.
float BrickLattice::measure_bend(const MarchBrick& brick) const {
  float bend = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::int32_t kFewest = 3;
    const bool has_nodes = brick.cells[axis] >= kFewest;
    bend +=
        0.125f * (has_nodes ? largest_bend(values_, {brick.cells[0] + 1, brick.cells[1] + 1, brick.cells[2] + 1}, axis)
                            : largest_bend(margin_, margin_block_.count, axis));
  }
  return bend;
}

void BrickLattice::fill_records(const Kernels& kernels, const MarchBrick& brick) {
  const std::int64_t nx = brick.cells[0] + 1, ny = brick.cells[1] + 1, nz = brick.cells[2] + 1;
  const std::vector<float>* nodes = &values_;
  if (stride_ > 1) {
    margin_.clear();
    for (std::int64_t k = 0; k < nz; ++k)
      for (std::int64_t j = 0; j < ny; ++j)
        for (std::int64_t i = 0; i < nx; ++i) {
          const auto at = [&](std::int64_t index, int axis) {
            return std::min(index * stride_, block_.count[axis] - 1);
          };
          margin_.push_back(
              values_[static_cast<std::size_t>((at(k, 2) * block_.count[1] + at(j, 1)) * block_.count[0] + at(i, 0))]);
        }
    margin_.resize(margin_.size() + kRecordPadding);
    nodes = &margin_;
  } else {
    values_.resize(values_.size() + kRecordPadding);
  }
  records_.resize(4 * (static_cast<std::size_t>((nx - 1) * (ny - 1) * nz) + kRecordPadding));
  kernels.make_records(nodes->data(), brick.cells, records_.data());
}

void BrickLattice::fill_densities(const optics::ControlPointTable& points, const MarchBrick& brick) {
  records_.assign(4 * (values_.size() + nodes_beyond(brick)), 0.0f);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const std::array<float, 4> densities = optics::eval_densities(points, values_[i]);
    std::copy(densities.begin(), densities.end(), records_.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
}

}  // namespace tetravox::cpu
