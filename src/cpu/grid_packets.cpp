#include "src/cpu/grid_packets.h"

#include "src/support/threads.h"

#include <limits>

namespace tetravox::cpu {
namespace {

/// Fewer bytes will be found in a cache.
constexpr std::size_t kCachedBytes = 8u << 20;

MarchValues describe_values(const PreparedGrid& grid) {
  const GridData& data = grid.data;
  MarchValues values;
  values.values = data.values.data();
  values.value_bytes = static_cast<int>(scalar_type_size(data.type));
  if (data.type == ScalarType::kInt8) {
    values.flip = 0x80808080u;
    values.offset = 128.0f;
  } else if (data.type == ScalarType::kUint16 && grid.scalar_range.max > std::numeric_limits<std::int16_t>::max()) {
    values.flip = 0x80008000u;
    values.offset = -32768.0f;
  }
  for (int axis = 0; axis < 3; ++axis) values.dimensions[axis] = static_cast<std::int32_t>(data.shape.dimensions[axis]);
  values.row_bytes = static_cast<std::ptrdiff_t>(values.dimensions[0]) * values.value_bytes;
  values.slice_bytes = values.row_bytes * values.dimensions[1];
  values.inverse_scale = static_cast<float>(1.0 / grid.scalar_scale);
  return values;
}

}  // namespace

const optics::SlabTable& SlabCache::prepare(const ValueRange& range, const IntegratorTables& tables,
                                            const Kernels& kernels, float thickness, bool wants_centers) {
  const bool lacks_centers = wants_centers && table_.centers.empty();
  if (thickness == thickness_ && tables.tolerance == tolerance_ && !lacks_centers) return table_;
  constexpr int kNodes = optics::SlabTable::kNodes;
  const auto width = static_cast<float>(optics::SlabTable::node_width(range));
  table_.first = static_cast<float>(range.min);
  table_.nodes_per_scalar = width > 0.0f ? 1.0f / width : 1.0f;
  table_.entries.resize(optics::SlabTable::kEntries);
  table_.centers.resize(wants_centers ? optics::SlabTable::kCenterBytes : 0);
  support::parallel_chunks(kNodes, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t front = begin; front < end; ++front)
      kernels.fill_slabs({&tables, &table_, static_cast<int>(front), thickness});
  });
  thickness_ = thickness;
  tolerance_ = tables.tolerance;
  return table_;
}

GridPackets::GridPackets(const PreparedGrid& grid, std::span<const std::uint8_t> seen_spans, March march,
                         const MarchJob& job)
    : march_(march), values_(describe_values(grid)), tables_(*job.tables), seen_spans_(seen_spans) {
  for (int axis = 0; axis < 3; ++axis) job_.brick_counts[axis] = static_cast<std::int32_t>(grid.bricks.counts[axis]);
  job_.is_large = grid.data.values.size() > kCachedBytes;
  job_.sample_distance = job.sample_distance;
  job_.use_early_ray_termination = job.use_early_ray_termination;
  job_.negligible = job.negligible;
  job_.grid = job.grid;
}

void GridPackets::use_slabs(const optics::SlabTable& slabs, March march) {
  march_ = march;
  tables_.slabs = &slabs;
  tables_.slab_thickness = job_.sample_distance;
  // From stored scalars to nodes.
  values_.offset += slabs.first / values_.inverse_scale;
  values_.inverse_scale *= slabs.nodes_per_scalar;
  job_.stored_per_scalar = 1.0f / slabs.nodes_per_scalar;
}

std::uint64_t GridPackets::draw(MarchRays& rays, int column, int row) const {
  PacketJob job = job_;
  job.rays = &rays;
  job.column = column;
  job.row = row;
  job.values = &values_;
  job.tables = &tables_;
  job.seen_spans = seen_spans_.data();
  return march_(job);
}

}  // namespace tetravox::cpu
