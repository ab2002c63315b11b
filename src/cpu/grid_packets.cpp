#include "src/cpu/grid_packets.h"

#include "src/support/threads.h"

namespace tetravox::cpu {
namespace {

/// Fewer bytes will be found in a cache.
constexpr std::size_t kCachedBytes = 8u << 20;

/// Scalars on both sides of their nodes cancel out: a picture errs by a hundredth at most (measured) of what it would
/// if all scalars of the longest ray were half a node off, to the same side, where the function is steepest.
constexpr double kRoundingPerTolerance = 30.0;

/// Stored scalars from node to node.
float node_width(const PreparedGrid& grid) {
  const double width = (grid.scalar_range.max - grid.scalar_range.min) / grid.scalar_scale;
  return static_cast<float>(width / (optics::SlabTable::kNodes - 1));
}

MarchValues describe_values(const PreparedGrid& grid) {
  const GridData& data = grid.data;
  MarchValues values;
  values.values = data.values.data();
  values.value_bytes = static_cast<int>(scalar_type_size(data.type));
  if (data.type == ScalarType::kInt8) {
    values.flip = 0x80808080u;
    values.offset = 128.0f;
  } else if (data.type == ScalarType::kInt16) {
    values.flip = 0x80008000u;
    values.offset = 32768.0f;
  }
  for (int axis = 0; axis < 3; ++axis) values.dimensions[axis] = static_cast<std::int32_t>(data.shape.dimensions[axis]);
  values.row_bytes = static_cast<std::ptrdiff_t>(values.dimensions[0]) * values.value_bytes;
  values.slice_bytes = values.row_bytes * values.dimensions[1];
  values.inverse_scale = static_cast<float>(1.0 / grid.scalar_scale);
  return values;
}

}  // namespace

bool SlabCache::may_round(const PreparedGrid& grid, float steepness, double longest, double tolerance) {
  return 0.5 * node_width(grid) * steepness * longest <= kRoundingPerTolerance * tolerance;
}

const optics::SlabTable& SlabCache::prepare(const PreparedGrid& grid, const IntegratorTables& tables,
                                            const Kernels& kernels, float thickness) {
  if (thickness == thickness_ && tables.tolerance == tolerance_) return table_;
  constexpr int kNodes = optics::SlabTable::kNodes;
  const float width = node_width(grid);
  table_.first = static_cast<float>((grid.scalar_range.min - grid.scalar_offset) / grid.scalar_scale);
  table_.nodes_per_scalar = width > 0.0f ? 1.0f / width : 1.0f;
  table_.entries.resize(static_cast<std::size_t>(kNodes) * kNodes);
  support::parallel_chunks(kNodes, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t front = begin; front < end; ++front)
      kernels.fill_slabs({&tables, &table_, static_cast<int>(front), thickness});
  });
  thickness_ = thickness;
  tolerance_ = tables.tolerance;
  return table_;
}

GridPackets::GridPackets(const PreparedGrid& grid, std::span<const scene::BrickPlan> plans, March march,
                         const MarchJob& job)
    : march_(march), values_(describe_values(grid)), tables_(*job.tables), seen_spans_(plans.size()) {
  for (std::size_t i = 0; i < plans.size(); ++i) seen_spans_[i] = plans[i].level != scene::BrickPlan::kTransparent;
  // The spans without an axis, of a brick and of the next one along it, are those with it.
  std::size_t stride = 1;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const std::size_t count = grid.bricks.counts[axis];
    job_.brick_counts[axis] = static_cast<std::int32_t>(count);
    for (std::size_t i = 0; i < plans.size(); ++i) {
      const bool has_next = i / stride % count + 1 < count;
      const unsigned without = seen_spans_[i], next = has_next ? seen_spans_[i + stride] : 0u;
      const unsigned known = (1u << (1u << axis)) - 1u;
      seen_spans_[i] = static_cast<std::uint8_t>(without | ((without | next) & known) << (1u << axis));
    }
    stride *= count;
  }
  job_.is_large = grid.data.values.size() > kCachedBytes;
  job_.sample_distance = job.sample_distance;
  job_.use_early_ray_termination = job.use_early_ray_termination;
  job_.negligible = job.negligible;
}

void GridPackets::use_slabs(const optics::SlabTable& slabs, March march) {
  march_ = march;
  tables_.slabs = &slabs;
  tables_.slab_thickness = job_.sample_distance;
  // From stored scalars to nodes.
  values_.offset += slabs.first / values_.inverse_scale;
  values_.inverse_scale *= slabs.nodes_per_scalar;
}

std::uint64_t GridPackets::draw(MarchRays& rays) const {
  PacketJob job = job_;
  job.rays = &rays;
  job.values = &values_;
  job.tables = &tables_;
  job.seen_spans = seen_spans_.data();
  return march_(job);
}

}  // namespace tetravox::cpu
