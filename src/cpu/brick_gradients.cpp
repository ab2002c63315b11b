#include "src/cpu/brick_gradients.h"

#include <algorithm>
#include <cmath>

namespace tetravox::cpu {
namespace {

/// Grid coordinate of a value.
double place_of(const DifferenceField& field, int axis, std::int64_t index) {
  if (!field.is_cell) return field.frame->plane(axis, index);
  return 0.5 * (static_cast<double>(field.frame->plane(axis, index)) + field.frame->plane(axis, index + 1));
}

/// Inverse distances from each value along an axis to the one before, the one after, and between these two; 0 where
/// there is none.
struct Distances {
  std::vector<float> before, after, both;
};
Distances measure_axis(const DifferenceField& field, const grid::Block& block, int axis) {
  Distances distances;
  const auto last = static_cast<std::int64_t>(field.value_dimensions[axis]) - 1;
  for (std::int64_t i = 0; i < block.count[axis]; ++i) {
    const std::int64_t at = std::clamp<std::int64_t>(block.first[axis] + i, 0, last);
    const double here = place_of(field, axis, at);
    const double low = at > 0 ? here - place_of(field, axis, at - 1) : 0.0;
    const double high = at < last ? place_of(field, axis, at + 1) - here : 0.0;
    const auto inverse = [](double distance) { return distance > 0.0 ? static_cast<float>(1.0 / distance) : 0.0f; };
    distances.before.push_back(inverse(low));
    distances.after.push_back(inverse(high));
    distances.both.push_back(inverse(low + high));
  }
  return distances;
}

}  // namespace

void find_central_gradients(const DifferenceField& field, const grid::Block& block, std::vector<float>& scratch,
                            std::vector<float>& gradients) {
  grid::Block around;
  for (int axis = 0; axis < 3; ++axis) {
    around.first[axis] = block.first[axis] - 1;
    around.count[axis] = block.count[axis] + 2;
  }
  scratch.resize(static_cast<std::size_t>(around.size()));
  field.reader->read(around, scratch.data());
  gradients.assign(4 * static_cast<std::size_t>(block.size()), 0.0f);
  const std::array<std::int64_t, 3> strides{1, around.count[0], around.count[0] * around.count[1]};
  for (int axis = 0; axis < 3; ++axis) {
    const Distances distances = measure_axis(field, block, axis);
    const std::int64_t stride = strides[axis];
    float* out = gradients.data() + axis;
    for (std::int64_t k = 0; k < block.count[2]; ++k)
      for (std::int64_t j = 0; j < block.count[1]; ++j) {
        const float* row = scratch.data() + ((k + 1) * strides[2] + (j + 1) * strides[1] + 1);
        for (std::int64_t i = 0; i < block.count[0]; ++i, out += 4) {
          const std::array<std::int64_t, 3> place{i, j, k};
          const auto at = static_cast<std::size_t>(place[axis]);
          const float low = row[i - stride], here = row[i], high = row[i + stride];
          float slope = (high - low) * distances.both[at];
          if (!(slope == slope)) {
            slope = (high - here) * distances.after[at];
            if (!(slope == slope)) slope = (here - low) * distances.before[at];
            if (!(slope == slope)) slope = 0.0f;
          }
          *out = slope;
        }
      }
  }
}

void refine_gradients(const std::array<std::int64_t, 3>& counts, int parts, const std::vector<float>& coarse,
                      std::vector<float>& fine) {
  std::array<std::int64_t, 3> nodes{};
  for (int axis = 0; axis < 3; ++axis) nodes[axis] = (counts[axis] - 1) * parts + 1;
  fine.assign(4 * static_cast<std::size_t>(nodes[0] * nodes[1] * nodes[2]), 0.0f);
  const auto split = [&](std::int64_t node, int axis, std::int64_t& index) {
    index = std::min(node / parts, counts[axis] - 2);
    return static_cast<float>(node - index * parts) / static_cast<float>(parts);
  };
  float* out = fine.data();
  for (std::int64_t k = 0; k < nodes[2]; ++k)
    for (std::int64_t j = 0; j < nodes[1]; ++j)
      for (std::int64_t i = 0; i < nodes[0]; ++i, out += 4) {
        std::int64_t x = 0, y = 0, z = 0;
        const float u = split(i, 0, x), v = split(j, 1, y), w = split(k, 2, z);
        for (int corner = 0; corner < 8; ++corner) {
          const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
          const float weight = (dx ? u : 1.0f - u) * (dy ? v : 1.0f - v) * (dz ? w : 1.0f - w);
          const float* from = coarse.data() + 4 * (((z + dz) * counts[1] + (y + dy)) * counts[0] + (x + dx));
          for (int channel = 0; channel < 3; ++channel) out[channel] += weight * from[channel];
        }
      }
}

void spread_gradients(const std::array<std::int64_t, 3>& counts, const std::array<std::int32_t, 3>& cells,
                      const std::vector<float>& at_points, std::vector<float>& spread) {
  spread.clear();
  for (std::int64_t k = 0; k < cells[2]; ++k)
    for (std::int64_t j = 0; j < cells[1]; ++j)
      for (std::int64_t i = 0; i < cells[0]; ++i) {
        const auto from =
            at_points.begin() +
            4 * static_cast<std::ptrdiff_t>(((k + 1) / 2 * counts[1] + (j + 1) / 2) * counts[0] + (i + 1) / 2);
        spread.insert(spread.end(), from, from + 4);
      }
}

}  // namespace tetravox::cpu
