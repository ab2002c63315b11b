#include "src/scene/kernel_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetravox::scene {
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

}  // namespace

void KernelLattice::read(const KernelField& field, const grid::Block& cells) {
  cells_ = cells;
  const int radius = field.kernel->radius();
  for (int axis = 0; axis < 3; ++axis) {
    margin_block_.first[axis] = cells.first[axis] - radius + 1 + field.padding;
    margin_block_.count[axis] = cells.count[axis] + 2 * radius;
  }
  margin_.resize(static_cast<std::size_t>(margin_block_.size()));
  field.reader->read(margin_block_, margin_.data());
}

void KernelLattice::divide(const KernelField& field, int parts, std::vector<float>& nodes) {
  const std::vector<float> weights = weight_table(*field.kernel, parts);
  convolve({&weights, &weights, &weights}, parts, nodes);
}

int KernelLattice::divide_as_asked(const KernelField& field, float steepness, int least_parts,
                                   std::vector<float>& nodes) {
  divide(field, 1, nodes);
  // The distance of a smooth field from its lattice falls with the square of the number of parts. It has the same sign
  // for many cells on end, so that it adds up where chords' errors do not.
  constexpr float kAddsUp = 4.0f;
  const float rate = kAddsUp * measure_bend(nodes) * steepness;
  int parts = least_parts;
  while (parts < field.most_parts && rate > field.allowed_rate * static_cast<float>(parts * parts)) parts *= 2;
  if (parts > 1) divide(field, parts, nodes);
  return parts;
}

void KernelLattice::differentiate(const KernelField& field, int parts, int axis, std::vector<float>& nodes) {
  const std::vector<float> weights = weight_table(*field.kernel, parts);
  const std::vector<float> slopes = derivative_table(*field.kernel, parts);
  const auto weights_of = [&](int i) { return i == axis ? &slopes : &weights; };
  convolve({weights_of(0), weights_of(1), weights_of(2)}, parts, nodes);
}

/// `weights`: for each axis, [parts][taps].
void KernelLattice::convolve(const std::array<const std::vector<float>*, 3>& weights, int parts,
                             std::vector<float>& nodes) {
  const int taps = static_cast<int>(weights[0]->size()) / parts;
  const auto& in = margin_block_.count;
  const std::int64_t nx = cells_.count[0] * parts + 1, ny = cells_.count[1] * parts + 1;
  convolve_axis({in[2] * in[1], in[0], 1, cells_.count[0], parts, taps}, *weights[0], margin_, along_x_);
  convolve_axis({in[2], in[1], nx, cells_.count[1], parts, taps}, *weights[1], along_x_, along_y_);
  convolve_axis({1, in[2], nx * ny, cells_.count[2], parts, taps}, *weights[2], along_y_, nodes);
}

/// Estimate of the distance of a field from the lattice of its nodes, by second differences: of the nodes, or of the
/// values in reach along an axis with too few of them.
float KernelLattice::measure_bend(const std::vector<float>& nodes) const {
  float bend = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::int64_t kFewest = 3;
    const bool has_nodes = cells_.count[axis] >= kFewest;
    bend +=
        0.125f * (has_nodes ? largest_bend(nodes, {cells_.count[0] + 1, cells_.count[1] + 1, cells_.count[2] + 1}, axis)
                            : largest_bend(margin_, margin_block_.count, axis));
  }
  return bend;
}

}  // namespace tetravox::scene
