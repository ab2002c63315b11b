#include "src/optics/centroid_table.h"

#include <bit>
#include <cmath>
#include <cstddef>

namespace tetravox::optics {

void build_centroid_table(const AntiderivativeTable& antiderivative, CentroidTable& table) {
  table.first = antiderivative.first;
  table.nodes_per_scalar = antiderivative.nodes_per_scalar;
  table.last_node = antiderivative.last_node;
  const std::int32_t count = table.last_node;
  table.sums.assign(4 * (static_cast<std::size_t>(count) + 1), 0);
  table.sums[3] = std::bit_cast<std::int32_t>(antiderivative.color_variation[0]);
  double moment = 0.0, second = 0.0;
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int32_t low = antiderivative.entries[i].sums[0], high = antiderivative.entries[i + 1].sums[0];
    // Within one interval between nodes the extinction counts as even.
    const double place = (i + 0.5) / count, extinction = static_cast<double>(high) - low;
    moment += extinction * place;
    second += extinction * place * place;
    const std::size_t node = 4 * (static_cast<std::size_t>(i) + 1);
    table.sums[node] = high;
    table.sums[node + 1] = static_cast<std::int32_t>(std::lround(moment));
    table.sums[node + 2] = static_cast<std::int32_t>(std::lround(second));
    table.sums[node + 3] = std::bit_cast<std::int32_t>(antiderivative.color_variation[i + 1]);
  }
}

}  // namespace tetravox::optics
