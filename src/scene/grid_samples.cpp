#include "src/scene/grid_samples.h"

#include "src/grid/values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tetravox::scene {
namespace {

constexpr std::size_t kBorderSteps = 96;  // along each edge of a face
constexpr double kNarrow = 0.12;          // of the values' range: the widest shortest half of a background
constexpr double kFewest = 1e-3;          // of the volume: an end with less beyond it is open
constexpr double kShortest = 0.05;        // of the values' range: so is one with less way beyond it
constexpr int kValleyBins = 128;          // between the background and the other end of the values
constexpr double kNothing = 0.01;         // of the background's peak: the histogram has fallen to nothing
constexpr double kLargestReach = 0.3;     // of the way to the other end that a background may take

std::vector<float> read_border(const grid::BlockReader& reader, const std::array<std::size_t, 3>& counts) {
  std::vector<float> border;
  const auto place = [&](std::size_t axis, std::size_t step, std::size_t steps) {
    return static_cast<std::int64_t>((2 * step + 1) * counts[axis] / (2 * steps));
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::size_t u_steps = std::min(kBorderSteps, counts[u]), v_steps = std::min(kBorderSteps, counts[v]);
    for (const bool is_last : {false, true})
      for (std::size_t b = 0; b < v_steps; ++b)
        for (std::size_t a = 0; a < u_steps; ++a) {
          grid::Block block{{0, 0, 0}, {1, 1, 1}};
          block.first[axis] = is_last ? static_cast<std::int64_t>(counts[axis]) - 1 : 0;
          block.first[u] = place(u, a, u_steps);
          block.first[v] = place(v, b, v_steps);
          float value = 0.0f;
          reader.read(block, &value);
          if (!std::isnan(value)) border.push_back(value);
        }
  }
  std::sort(border.begin(), border.end());
  return border;
}

/// The range of the samples without a thousandth of their weight at either end; all of it where that leaves nothing.
ValueRange range_of(const GridSamples& samples) {
  constexpr double kTail = 1e-3;
  std::vector<std::uint32_t> order(samples.values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return samples.values[a] < samples.values[b]; });
  double total = 0.0, below = 0.0;
  for (const float weight : samples.weights) total += weight;
  ValueRange all{samples.values[order.front()], samples.values[order.back()]}, range{all.max, all.min};
  for (const std::uint32_t i : order) {
    const double value = samples.values[i];
    if (below + samples.weights[i] > kTail * total) range.min = std::min(range.min, value);
    if (below <= (1.0 - kTail) * total) range.max = value;
    below += samples.weights[i];
  }
  return range.min < range.max ? range : all;
}

/// Where the histogram has fallen from the peak at `from` to a valley or to nothing, on the way to `to`.
double find_valley(const GridSamples& samples, double from, double to) {
  std::vector<double> counts(kValleyBins + 2), smooth(kValleyBins);
  const double bins_per_value = kValleyBins / (to - from);
  for (std::size_t i = 0; i < samples.values.size(); ++i) {
    const double bin = (samples.values[i] - from) * bins_per_value;
    // What lies on the far side of the peak counts for the peak.
    if (bin < kValleyBins) counts[static_cast<std::size_t>(std::max(bin, 0.0)) + 1] += samples.weights[i];
  }
  for (std::size_t i = 0; i < kValleyBins; ++i)
    smooth[i] = 0.25 * counts[i] + 0.5 * counts[i + 1] + 0.25 * counts[i + 2];
  smooth[0] = std::max(counts[1], smooth[1]);
  const auto last = static_cast<std::size_t>(kLargestReach * kValleyBins);
  std::size_t end = 1;
  while (end < last) {
    const bool is_valley = smooth[end] <= smooth[end + 1] && smooth[end] <= smooth[end + 2];
    if (is_valley || smooth[end] < kNothing * smooth[0]) break;
    ++end;
  }
  return from + static_cast<double>(end) / bins_per_value;
}

}  // namespace

std::vector<double> widths_along(const GridData& grid, std::size_t axis) {
  const std::size_t points = grid.shape.dimensions[axis];
  const std::vector<double>& places = grid.shape.coordinates[axis];
  const auto width = [&](std::size_t cell) { return places.empty() ? 1.0 : places[cell + 1] - places[cell]; };
  std::vector<double> widths(grid.value_dimensions()[axis]);
  for (std::size_t cell = 0; cell + 1 < points; ++cell) {
    if (grid.association == Association::kCell) {
      widths[cell] = width(cell);
    } else {
      widths[cell] += 0.5 * width(cell);
      widths[cell + 1] += 0.5 * width(cell);
    }
  }
  return widths;
}

std::vector<std::size_t> choose_rows(std::size_t rows, std::size_t wanted) {
  std::vector<std::size_t> chosen(wanted);
  for (std::size_t n = 0; n < wanted; ++n) {
    const double golden = std::fmod(0.6180339887498949 * static_cast<double>(n), 1.0);
    const double at = (static_cast<double>(n) + (wanted < rows ? golden : 0.5)) * static_cast<double>(rows);
    chosen[n] = std::min(rows - 1, static_cast<std::size_t>(at / static_cast<double>(wanted)));
  }
  return chosen;
}

GridSamples sample_grid(const PreparedGrid& grid, std::size_t largest_count) {
  const grid::BlockReader reader(grid.data, {grid.scalar_offset, grid.scalar_scale});
  const std::array<std::size_t, 3> counts = grid.data.value_dimensions();
  const std::vector<double> widths[3] = {widths_along(grid.data, 0), widths_along(grid.data, 1),
                                         widths_along(grid.data, 2)};
  const std::size_t rows = counts[1] * counts[2];
  const std::size_t wanted = std::clamp<std::size_t>(largest_count / counts[0], 1, rows);
  GridSamples samples;
  std::vector<float> row(counts[0]);
  for (const std::size_t index : choose_rows(rows, wanted)) {
    const std::size_t j = index % counts[1], k = index / counts[1];
    const grid::Block block{{0, static_cast<std::int64_t>(j), static_cast<std::int64_t>(k)},
                            {static_cast<std::int64_t>(counts[0]), 1, 1}};
    reader.read(block, row.data());
    for (std::size_t i = 0; i < counts[0]; ++i) {
      if (std::isnan(row[i])) continue;
      samples.values.push_back(row[i]);
      samples.weights.push_back(static_cast<float>(widths[0][i] * widths[1][j] * widths[2][k]));
    }
  }
  samples.border = read_border(reader, counts);
  return samples;
}

std::optional<Background> find_background(const GridSamples& samples) {
  const std::vector<float>& border = samples.border;
  if (border.size() < 2 || samples.values.empty()) return std::nullopt;
  const std::size_t half = border.size() / 2;
  std::size_t best = 0;
  for (std::size_t i = 0; i + half < border.size(); ++i)
    if (border[i + half] - border[i] < border[best + half] - border[best]) best = i;
  const double low = border[best], high = border[best + half];

  const ValueRange range = range_of(samples);
  const double width = std::max(range.max, high) - std::min(range.min, low);
  if (!(width > 0.0) || high - low > kNarrow * width) return std::nullopt;

  // From the peak to either side, as far as the peak reaches; open where nothing much is left beyond.
  const double peak = 0.5 * (low + high);
  const auto reach = [&](double end, double direction) {
    const double open = direction * std::numeric_limits<double>::infinity();
    if (!(direction * (end - peak) > kShortest * width)) return open;
    const double valley = find_valley(samples, peak, end);
    double beyond = 0.0, total = 0.0;
    for (std::size_t i = 0; i < samples.values.size(); ++i) {
      total += samples.weights[i];
      if (direction * (samples.values[i] - valley) > 0.0) beyond += samples.weights[i];
    }
    return beyond > kFewest * total ? valley : open;
  };
  const Background background{static_cast<float>(reach(std::min(range.min, low), -1.0)),
                              static_cast<float>(reach(std::max(range.max, high), 1.0))};
  if (std::isinf(background.low) && std::isinf(background.high)) return std::nullopt;
  return background;
}

}  // namespace tetravox::scene
