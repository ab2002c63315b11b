#include "src/optics/preintegration_table.h"

#include "src/optics/pair_integrals.h"
#include "src/optics/record_mix.h"
#include "src/support/memory.h"

#include <cmath>
#include <string>

namespace tetravox::optics {

std::uint64_t preintegration_table_bytes(int scalars, int lengths) {
  return static_cast<std::uint64_t>(scalars) * static_cast<std::uint64_t>(scalars) *
         static_cast<std::uint64_t>(lengths) * 4 * sizeof(float);
}

void build_preintegration_table(const PreintegrationSource& source, const PreintegrationSettings& settings,
                                PreintegrationTable& table) {
  const int scalars = settings.scalars, lengths = settings.lengths;
  const std::uint64_t bytes = preintegration_table_bytes(scalars, lengths);
  if (bytes > table.bytes())
    support::require_memory(bytes - table.bytes(), "a pre-integration table of " + std::to_string(scalars) + " x " +
                                                       std::to_string(scalars) + " x " + std::to_string(lengths));
  const SegmentIntegral function(source.function, find_table_range(source));
  table.domain = make_segment_domain(source);
  table.scalars = scalars;
  table.lengths = lengths;
  table.spacing = settings.length_spacing;
  table.entries.resize(bytes / sizeof(float));

  const double largest = function.largest_extinction();
  std::vector<double> world, bounds;  // of the lengths above 0
  for (int k = 1; k < lengths; ++k) {
    world.push_back(share_of_length_place(table.spacing, static_cast<double>(k) / (lengths - 1)) * source.longest);
    bounds.push_back(-std::expm1(-largest * world.back()));
  }
  const std::size_t layer = 4 * static_cast<std::size_t>(scalars) * static_cast<std::size_t>(scalars);
  const auto store = [&](int front, int back, std::span<const Slab> by_length) {
    float* entry = table.entries.data() + 4 * (static_cast<std::size_t>(back) * scalars + front);
    const OpticalDensity limit =
        function.mean(static_cast<double>(front) / (scalars - 1), static_cast<double>(back) / (scalars - 1));
    store_quotient({{limit[1], limit[2], limit[3]}, limit[0]}, largest, settings.bits, entry);
    for (std::size_t k = 0; k < by_length.size(); ++k)
      store_quotient(by_length[k], bounds[k], settings.bits, entry + (k + 1) * layer);
  };
  integrate_pairs(function, {scalars, world, settings.steps, &source.progress}, settings.use_incremental, store);
}

SegmentColor eval_preintegration_table(const PreintegrationTable& table, float scalar_front, float scalar_back,
                                       float length) {
  const SegmentDomain& domain = table.domain;
  const float share = std::min(length, domain.longest) / domain.longest;
  const Node x = find_node(eval_scalar_place(domain, scalar_front), table.scalars);
  const Node y = find_node(eval_scalar_place(domain, scalar_back), table.scalars);
  const Node z = find_node(eval_length_place(table.spacing, share), table.lengths);
  const std::size_t row = static_cast<std::size_t>(table.scalars), layer = row * row;
  const std::size_t first = z.index * layer + y.index * row + x.index;
  const FloatRecord near = mix_square(table.entries.data(), first, row, x.part, y.part);
  const FloatRecord far = mix_square(table.entries.data(), first + layer, row, x.part, y.part);
  return unfold(mix(z.part, near, far), eval_opacity_bound(domain, length));
}

}  // namespace tetravox::optics
