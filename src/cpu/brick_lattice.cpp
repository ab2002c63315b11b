#include "src/cpu/brick_lattice.h"

#include "src/grid/summaries.h"
#include "src/scene/brick_groups.h"

#include <algorithm>
#include <cmath>

namespace tetravox::cpu {
namespace {

scene::KernelField kernel_field(const LatticeField& field) {
  return {field.reader, field.padding, field.kernel, field.most_parts, field.allowed_rate};
}

/// Nodes behind the last one that a ray at the very end of the brick may look at.
std::size_t nodes_beyond(const MarchBrick& brick) {
  const auto row = static_cast<std::size_t>(brick.cells[0]) + 1;
  return row * (static_cast<std::size_t>(brick.cells[1]) + 1) + row + 1;
}

}  // namespace

void BrickLattice::prefetch(const LatticeField& field, const PreparedGrid& grid, std::uint32_t brick) {
  if (scene::is_group(grid, brick)) return;
  const grid::BrickBox box = scene::box_of_drawn(grid, brick);
  grid::Block block{box.first, box.count};
  for (std::int64_t& first : block.first) first += field.padding;
  field.reader->prefetch(block);
}

MarchBrick BrickLattice::describe(const PreparedGrid& grid, const grid::GridFrame& frame, std::uint32_t index,
                                  int level) {
  const grid::BrickBox box = scene::box_of_drawn(grid, index);
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
  brick.has_missing = !scene::is_group(grid, index) && grid.bricks.has_missing[index] != 0;
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

void BrickLattice::fill_group(const LatticeField& field, MarchBrick& brick) {
  values_.clear();
  for (std::int64_t corner = 0; corner < 8; ++corner) {
    grid::Block at{block_.first, {1, 1, 1}};
    for (int axis = 0; axis < 3; ++axis) at.first[axis] += (corner >> axis & 1) * block_.count[axis];
    values_.push_back(0.0f);
    field.reader->read(at, &values_.back());
  }
  block_.count = {2, 2, 2};
  stride_ = 1;
  fill_records(*field.kernels, brick);
  brick.records = records_.data();
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

/// Divides the cells of the brick into `parts` along each axis.
void BrickLattice::divide_cells(int parts, MarchBrick& brick) {
  for (int axis = 0; axis < 3; ++axis) brick.cells[axis] = static_cast<std::int32_t>(block_.count[axis] * parts);
  if (brick.is_uneven) place_planes(brick, parts);
}

/// Returns into how many parts the cells are divided.
int BrickLattice::filter_values(const LatticeField& field, MarchBrick& brick, int least_parts) {
  const scene::KernelField of_kernel = kernel_field(field);
  filtered_.read(of_kernel, block_);
  const int least =
      std::max(brick.has_missing ? 2 : 1, least_parts);  // in the middle of a cell everything in reach counts
  const int parts = filtered_.divide_as_asked(of_kernel, brick.steepness, least, values_);
  divide_cells(parts, brick);
  if (field.gradients == GradientSource::kKernel) filter_gradients(field, parts, brick);
  for (int axis = 0; axis < 3; ++axis) block_.count[axis] = brick.cells[axis] + 1;
  return parts;
}

/// Gradients at the nodes of the lattice: the derivative along one axis, the kernel itself along the others.
void BrickLattice::filter_gradients(const LatticeField& field, int parts, const MarchBrick& brick) {
  for (int axis = 0; axis < 3; ++axis) {
    filtered_.differentiate(kernel_field(field), parts, axis, coarse_gradients_);
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
  const scene::KernelField of_kernel = kernel_field(field);
  filtered_.read(of_kernel, block_);
  divide_cells(scene::kDensityParts, brick);
  const std::vector<float> scalars = filtered_.margin();
  for (std::size_t channel = 0; channel < 4; ++channel) {
    for (std::size_t i = 0; i < scalars.size(); ++i)
      filtered_.margin()[i] = optics::eval_densities(*field.points, scalars[i])[channel];
    filtered_.divide(of_kernel, scene::kDensityParts, values_);
    if (channel == 0) records_.assign(4 * (values_.size() + nodes_beyond(brick)), 0.0f);
    for (std::size_t i = 0; i < values_.size(); ++i) records_[4 * i + channel] = values_[i];
  }
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
