#include "src/grid/values.h"

#include "src/grid/visit_type.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace tetravox::grid {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr double kLargestFloat = std::numeric_limits<float>::max();

/// The type in which a value is moved and scaled: float where that loses nothing.
template <class T>
using Working = std::conditional_t<(sizeof(T) <= 2 || std::is_same_v<T, float>), float, double>;

template <class T, class W>
void read_scalars(const std::byte* row, int components, int component, std::int64_t count, double offset,
                  double inverse_scale, float* out) {
  const T* values = reinterpret_cast<const T*>(row) + component;
  const auto moved = static_cast<W>(offset), scale = static_cast<W>(inverse_scale);
  const auto read = [&](std::int64_t from, std::int64_t to) {
    const auto stored = static_cast<float>((static_cast<W>(values[from]) - moved) * scale);
    if constexpr (std::is_floating_point_v<T>)
      out[to] = stored - stored == 0.0f ? stored : kMissing;
    else
      out[to] = stored;
  };
  if (components == 1)
    for (std::int64_t i = 0; i < count; ++i) read(i, i);  // in vectors
  else
    for (std::int64_t i = 0; i < count; ++i) read(i * components, i);
}

template <class T>
void read_magnitudes(const std::byte* row, int components, int, std::int64_t count, double offset, double inverse_scale,
                     float* out) {
  const T* values = reinterpret_cast<const T*>(row);
  for (std::int64_t i = 0; i < count; ++i) {
    double sum = 0.0;
    for (int c = 0; c < components; ++c) {
      const auto value = static_cast<double>(values[i * components + c]);
      sum += value * value;
    }
    const auto stored = static_cast<float>((std::sqrt(sum) - offset) * inverse_scale);
    out[i] = stored - stored == 0.0f ? stored : kMissing;
  }
}

}  // namespace

ScalarFrame choose_scalar_frame(const ValueRange& range) {
  ScalarFrame frame;
  const double largest_value = std::max(std::abs(range.min), std::abs(range.max));
  if (range.max * 0.5 - range.min * 0.5 < 0.25 * largest_value)
    frame.offset = static_cast<double>(static_cast<float>(range.min * 0.5 + range.max * 0.5));
  if (!std::isfinite(frame.offset)) frame.offset = 0.0;
  const double largest = std::max(std::abs(range.min - frame.offset), std::abs(range.max - frame.offset));
  if (largest > 0.0) frame.scale = std::ldexp(1.0, std::max(std::ilogb(largest), -1000));
  return frame;
}

BlockReader::BlockReader(const GridData& grid, const ScalarFrame& frame)
    : values_(grid.values.data()),
      value_bytes_(scalar_type_size(grid.type) * static_cast<std::size_t>(grid.components)),
      components_(grid.components),
      component_(grid.component),
      offset_(frame.offset),
      inverse_scale_(1.0 / frame.scale) {
  const auto dimensions = grid.value_dimensions();
  for (int axis = 0; axis < 3; ++axis) dimensions_[axis] = static_cast<std::int64_t>(dimensions[axis]);
  // Float cannot hold the factor of tiny or huge values: then everything goes through double.
  const bool fits = inverse_scale_ <= kLargestFloat && inverse_scale_ >= std::numeric_limits<float>::min();
  read_row_ = visit_type(grid.type, [&](auto value) -> ReadRow {
    using T = decltype(value);
    if (grid.component == kMagnitude) return &read_magnitudes<T>;
    return fits ? &read_scalars<T, Working<T>> : &read_scalars<T, double>;
  });
}

void BlockReader::read_row(std::int64_t j, std::int64_t k, const Block& block, float* out) const {
  const std::int64_t last = dimensions_[0] - 1;
  const std::int64_t begin = std::clamp(block.first[0], std::int64_t{0}, last);
  const std::int64_t end = std::clamp(block.first[0] + block.count[0] - 1, std::int64_t{0}, last) + 1;
  const std::int64_t row = (std::clamp(k, std::int64_t{0}, dimensions_[2] - 1) * dimensions_[1] +
                            std::clamp(j, std::int64_t{0}, dimensions_[1] - 1)) *
                           dimensions_[0];
  const std::int64_t before = std::clamp(begin - block.first[0], std::int64_t{0}, block.count[0] - 1);
  const std::int64_t inside = std::min(end - begin, block.count[0] - before);
  read_row_(values_ + static_cast<std::size_t>(row + begin) * value_bytes_, components_, component_, inside, offset_,
            inverse_scale_, out + before);
  std::fill_n(out, before, out[before]);
  std::fill(out + before + inside, out + block.count[0], out[before + inside - 1]);
}

bool BlockReader::is_inside(const Block& block) const {
  bool is_inside = true;
  for (int axis = 0; axis < 3; ++axis)
    is_inside &= block.first[axis] >= 0 && block.first[axis] + block.count[axis] <= dimensions_[axis];
  return is_inside;
}

const std::byte* BlockReader::row_of(const Block& block, std::int64_t j, std::int64_t k) const {
  const std::int64_t row = ((block.first[2] + k) * dimensions_[1] + block.first[1] + j) * dimensions_[0];
  return values_ + static_cast<std::size_t>(row + block.first[0]) * value_bytes_;
}

void BlockReader::prefetch(const Block& block) const {
  if (!is_inside(block)) return;
  for (std::int64_t k = 0; k < block.count[2]; ++k)
    for (std::int64_t j = 0; j < block.count[1]; ++j) __builtin_prefetch(row_of(block, j, k));
}

void BlockReader::read(const Block& block, float* out) const {
  if (is_inside(block)) {
    for (std::int64_t k = 0; k < block.count[2]; ++k)
      for (std::int64_t j = 0; j < block.count[1]; ++j, out += block.count[0])
        read_row_(row_of(block, j, k), components_, component_, block.count[0], offset_, inverse_scale_, out);
    return;
  }
  for (std::int64_t k = 0; k < block.count[2]; ++k)
    for (std::int64_t j = 0; j < block.count[1]; ++j)
      read_row(block.first[1] + j, block.first[2] + k, block, out + (k * block.count[1] + j) * block.count[0]);
}

}  // namespace tetravox::grid
