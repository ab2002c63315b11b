#include "src/optics/environment_filter.h"

#include "src/optics/sphere_bins.h"
#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace tetravox::optics {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr int kDiffuseNodes = 49;
constexpr double kDiffuseSpacing = 0.05;
constexpr double kLobeEnd = 1e-4;  ///< part of its height

/// The lobe of shininess N falls like a Gaussian of this deviation.
double deviation_of(double shininess) { return 2.0 / std::sqrt(shininess); }

/// Nodes a side, so that bilinear interpolation errs by less than a hundredth of a small light's highlight.
int specular_nodes(double shininess) {
  return std::clamp(static_cast<int>(std::ceil(16.0 / deviation_of(shininess))), 49, 144);
}

/// Weight of light by q = 1 - cosine of its angle with the middle of the lobe; 0 beyond `reach`.
class Lobe {
 public:
  template <class Weight>
  Lobe(double reach, const Weight& weight) : reach_(reach), nodes_per_q_(static_cast<float>(kSteps / reach)) {
    for (int i = 0; i <= kSteps; ++i)
      weights_[static_cast<std::size_t>(i)] = static_cast<float>(weight(reach * i / kSteps));
  }

  double reach() const { return reach_; }
  float operator()(float q) const {
    const float at = std::min(std::max(q * nodes_per_q_, 0.0f), static_cast<float>(kSteps));
    const int node = static_cast<int>(at);
    const float* weight = weights_.data() + node;
    return weight[0] + (at - static_cast<float>(node)) * (weight[1] - weight[0]);
  }

 private:
  static constexpr int kSteps = 2048;
  double reach_;
  float nodes_per_q_;
  std::array<float, kSteps + 2> weights_{};  // one more: the last node is asked for its neighbour
};

Lobe diffuse_lobe() {
  return {1.0, [](double q) { return std::max(0.0, 1.0 - q); }};
}

Lobe specular_lobe(double shininess) {
  const double reach = 2.0 * (1.0 - std::pow(kLobeEnd, 2.0 / shininess));
  return {reach,
          [=](double q) { return std::max(0.0, std::pow(std::max(0.0, 1.0 - 0.5 * q), 0.5 * shininess) - kLobeEnd); }};
}

using Sums = std::array<float, 4>;

/// The light of bins that lie side by side.
Sums sum_bins(const Glow* bin, std::size_t count, const std::array<float, 3>& d, const Lobe& lobe) {
  float red = 0.0f, green = 0.0f, blue = 0.0f, white = 0.0f;
  for (const Glow* end = bin + count; bin != end; ++bin) {
    const float cosine = d[0] * bin->direction[0] + d[1] * bin->direction[1] + d[2] * bin->direction[2];
    const float weight = lobe(1.0f - cosine);
    red += bin->flux[0] * weight;
    green += bin->flux[1] * weight;
    blue += bin->flux[2] * weight;
    white += bin->flux[3] * weight;
  }
  return {red, green, blue, white};
}

/// The bins within reach of a direction.
struct Cap {
  double height = 0.0, radius = 0.0, longitude = 0.0;  ///< of the direction: up, across, 0 behind
  double cosine = 0.0;                                 ///< of the reach
};

/// Bins of a row: `count` from `first` on, and around.
struct Columns {
  std::size_t first = 0, count = 0;
};

/// Those of a row inside the cap, by the law of cosines on the sphere.
Columns find_columns(const SphereBins& bins, std::size_t row, const Cap& cap) {
  const auto columns = static_cast<std::size_t>(bins.columns[row]);
  const double height = bins.heights[row], across = std::sqrt(1.0 - height * height) * cap.radius;
  const double above = cap.cosine - height * cap.height;
  if (above >= across) return {};
  if (above <= -across) return {0, columns};
  const double half = std::acos(above / across), per_radian = static_cast<double>(columns) / (2.0 * kPi);
  const double first = std::floor((cap.longitude - half) * per_radian);
  const auto count = static_cast<std::size_t>(std::floor((cap.longitude + half) * per_radian) - first) + 1;
  if (count >= columns) return {0, columns};
  const auto index = static_cast<long long>(first), period = static_cast<long long>(columns);
  return {static_cast<std::size_t>(index < 0 ? index + period : index), count};
}

/// The environment about a direction, weighted by the lobe.
std::array<float, 3> gather_lobe(const SphereBins& bins, const Lobe& lobe, const Vector3& direction) {
  const std::array<float, 3> d{static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                               static_cast<float>(direction[2])};
  const auto rows = static_cast<double>(bins.row_count());
  // A bin belongs to the lobe where any place of it does.
  const double reach = std::min(kPi, std::acos(std::max(-1.0, 1.0 - lobe.reach())) + kPi / rows);
  const Cap cap{direction[1], std::hypot(direction[0], direction[2]), std::atan2(direction[0], direction[2]) + kPi,
                std::cos(reach)};
  const double colatitude = std::acos(std::clamp(direction[1], -1.0, 1.0));
  const auto row_at = [&](double place) {
    return static_cast<std::size_t>(std::clamp(place * rows / kPi, 0.0, rows - 1.0));
  };
  std::array<double, 4> totals{};
  for (std::size_t row = row_at(colatitude - reach); row <= row_at(colatitude + reach); ++row) {
    const Columns columns = find_columns(bins, row, cap);
    if (columns.count == 0) continue;
    const Glow* first = bins.bins.data() + bins.starts[row];
    const std::size_t until_end = static_cast<std::size_t>(bins.columns[row]) - columns.first;
    const std::size_t before_wrap = std::min(columns.count, until_end);
    const Sums one = sum_bins(first + columns.first, before_wrap, d, lobe);
    const Sums other = sum_bins(first, columns.count - before_wrap, d, lobe);
    for (std::size_t c = 0; c < 4; ++c) totals[c] += static_cast<double>(one[c]) + static_cast<double>(other[c]);
  }
  std::array<float, 3> mean{};
  for (std::size_t c = 0; c < 3; ++c) mean[c] = totals[3] > 0.0 ? static_cast<float>(totals[c] / totals[3]) : 0.0f;
  return mean;
}

/// The unit vector of a node: see `DirectionTable`. Nodes of two faces that coincide have the same bits.
Vector3 node_direction(int size, int face, int column, int row) {
  const auto place = [&](int index) { return static_cast<double>(2 * index - (size - 1)) / (size - 1); };
  const auto axis = static_cast<std::size_t>(face / 2);
  Vector3 direction{};
  direction[axis] = face % 2 == 0 ? 1.0 : -1.0;
  direction[(axis + 1) % 3] = place(column);
  direction[(axis + 2) % 3] = place(row);
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  for (double& component : direction) component /= length;
  return direction;
}

DirectionTable tabulate(const SphereBins& bins, const Lobe& lobe, int size) {
  const auto nodes = static_cast<std::size_t>(size);
  DirectionTable table{size, std::vector<float>(6 * nodes * nodes * 4)};
  support::parallel_chunks(6 * nodes, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t line = begin; line < end; ++line)
      for (std::size_t column = 0; column < nodes; ++column) {
        const Vector3 direction = node_direction(size, static_cast<int>(line / nodes), static_cast<int>(column),
                                                 static_cast<int>(line % nodes));
        const std::array<float, 3> color = gather_lobe(bins, lobe, direction);
        std::copy(color.begin(), color.end(), table.records.begin() + 4 * (line * nodes + column));
      }
  });
  return table;
}

std::array<float, 3> find_mean(const SphereBins& bins) {
  std::array<double, 4> totals{};
  for (const Glow& bin : bins.bins)
    for (std::size_t c = 0; c < 4; ++c) totals[c] += bin.flux[c];
  std::array<float, 3> mean{};
  for (std::size_t c = 0; c < 3; ++c) mean[c] = static_cast<float>(totals[c] / totals[3]);
  return mean;
}

}  // namespace

FilteredEnvironment filter_environment(const Environment& environment, double shininess) {
  FilteredEnvironment filtered;
  const SphereBins wide = gather_environment(environment, kDiffuseSpacing);
  filtered.diffuse = tabulate(wide, diffuse_lobe(), kDiffuseNodes);
  filtered.mean = find_mean(wide);
  const SphereBins narrow = gather_environment(environment, std::min(0.1, deviation_of(shininess) / 3.0));
  filtered.specular = tabulate(narrow, specular_lobe(shininess), specular_nodes(shininess));
  return filtered;
}

}  // namespace tetravox::optics
