#include "src/grid/summaries.h"

#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::grid {
namespace {

constexpr int kNodes = kBrickCells + 1;
constexpr std::size_t kMostNodes = static_cast<std::size_t>(kNodes) * kNodes * kNodes;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A brick's values, [k][j][i].
struct BrickValues {
  std::array<std::int64_t, 3> count{};
  std::array<float, kMostNodes> values;

  float at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return values[static_cast<std::size_t>((k * count[1] + j) * count[0] + i)];
  }
};

/// Bound on the distance of the field from the chord of any ray through one cell of `stride` nodes a side. Along a ray
/// the second derivative is twice the sum of the mixed differences, each weighted by at most one.
float bound_bend(const BrickValues& brick, std::int64_t stride) {
  float xy = 0.0f, xz = 0.0f, yz = 0.0f;
  const std::int64_t s = stride;
  for (std::int64_t k = 0; k < brick.count[2]; k += s)
    for (std::int64_t j = 0; j < brick.count[1]; j += s)
      for (std::int64_t i = 0; i < brick.count[0]; i += s) {
        const bool has_x = i + s < brick.count[0], has_y = j + s < brick.count[1], has_z = k + s < brick.count[2];
        const float v = brick.at(i, j, k);
        if (has_x && has_y)
          xy = std::max(xy, std::abs(v - brick.at(i + s, j, k) - brick.at(i, j + s, k) + brick.at(i + s, j + s, k)));
        if (has_x && has_z)
          xz = std::max(xz, std::abs(v - brick.at(i + s, j, k) - brick.at(i, j, k + s) + brick.at(i + s, j, k + s)));
        if (has_y && has_z)
          yz = std::max(yz, std::abs(v - brick.at(i, j + s, k) - brick.at(i, j, k + s) + brick.at(i, j + s, k + s)));
      }
  return 0.25f * (xy + xz + yz);
}

/// Largest distance of the values of a whole brick from those interpolated between every `stride`-th.
float measure_coarse_error(const BrickValues& brick, std::int64_t stride) {
  float coarse[kMostNodes];
  std::copy(brick.values.begin(), brick.values.end(), coarse);
  // Interpolate along one axis after the other, in place.
  const std::array<std::int64_t, 3> strides{1, kNodes, kNodes * kNodes};
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t along = strides[axis], u = strides[(axis + 1) % 3], v = strides[(axis + 2) % 3];
    const std::int64_t u_step = axis < 2 ? stride : 1, v_step = axis < 1 ? stride : 1;
    for (std::int64_t b = 0; b < kNodes; b += v_step)
      for (std::int64_t a = 0; a < kNodes; a += u_step)
        for (std::int64_t base = 0; base < kBrickCells; base += stride) {
          float* from = coarse + a * u + b * v + base * along;
          const float low = from[0], slope = (from[stride * along] - low) / static_cast<float>(stride);
          for (std::int64_t i = 1; i < stride; ++i) from[i * along] = low + slope * static_cast<float>(i);
        }
  }
  float error = 0.0f;
  for (std::size_t i = 0; i < kMostNodes; ++i) error = std::max(error, std::abs(coarse[i] - brick.values[i]));
  return error;
}

/// Finds range and missing values; min > max where all are missing.
void summarize_range(const BrickValues& brick, std::size_t size, float& min, float& max, bool& has_missing) {
  min = kInfinity;
  max = -kInfinity;
  has_missing = false;
  for (std::size_t i = 0; i < size; ++i) {
    const float value = brick.values[i];
    has_missing |= value != value;
    min = value < min ? value : min;
    max = value > max ? value : max;
  }
}

}  // namespace

BrickBox box_of_brick(const GridShape& shape, const std::array<std::uint32_t, 3>& brick) {
  BrickBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.first[axis] = static_cast<std::int64_t>(brick[axis]) * kBrickCells;
    box.count[axis] = std::min<std::int64_t>(kBrickCells, shape.dimensions[axis] - 1 - box.first[axis]);
  }
  return box;
}

BrickSummaries summarize_bricks(const GridData& grid, const ScalarFrame& frame, const Progress& progress) {
  BrickSummaries bricks;
  for (int axis = 0; axis < 3; ++axis)
    bricks.counts[axis] = (grid.shape.dimensions[axis] - 1 + kBrickCells - 1) / kBrickCells;
  const std::size_t row = bricks.counts[0], count = row * bricks.counts[1] * bricks.counts[2];
  bricks.min.resize(count);
  bricks.max.resize(count);
  bricks.has_missing.resize(count);
  for (auto& level : bricks.deviation) level.resize(count);
  const BlockReader reader(grid, frame);
  const bool is_point = grid.association == Association::kPoint;
  const bool is_even = std::all_of(grid.shape.coordinates.begin(), grid.shape.coordinates.end(),
                                   [](const std::vector<double>& axis) { return axis.empty(); });

  support::parallel_chunks(count / row, 1, [&](std::size_t begin, std::size_t end) {
    BrickValues brick;
    for (std::size_t index = begin * row; index < end * row; ++index) {
      if (index % row == 0) support::throw_if_cancelled(progress);
      const BrickBox box = box_of_brick(grid.shape, {static_cast<std::uint32_t>(index % row),
                                                     static_cast<std::uint32_t>(index / row % bricks.counts[1]),
                                                     static_cast<std::uint32_t>(index / row / bricks.counts[1])});
      Block block{box.first, box.count};
      if (is_point)
        for (std::int64_t& nodes : block.count) ++nodes;
      brick.count = block.count;
      reader.read(block, brick.values.data());
      const auto size = static_cast<std::size_t>(block.size());
      bool has_missing = false;
      summarize_range(brick, size, bricks.min[index], bricks.max[index], has_missing);
      bricks.has_missing[index] = has_missing;
      const bool is_constant = bricks.min[index] == bricks.max[index] && !has_missing;
      const bool is_whole = is_point && is_even && size == kMostNodes && !has_missing;
      bricks.deviation[0][index] = is_constant || !is_point ? 0.0f : bound_bend(brick, 1);
      for (int level = 1; level < 4; ++level) {
        const std::int64_t stride = std::int64_t{1} << level;
        bricks.deviation[level][index] = is_constant ? 0.0f
                                         : is_whole  ? measure_coarse_error(brick, stride) + bound_bend(brick, stride)
                                                     : kInfinity;
      }
    }
  });
  return bricks;
}

}  // namespace tetravox::grid
