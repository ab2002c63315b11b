#pragma once

/// Grids at a fixed rate whose values serve as they lie in memory (scene::counts_steps): rays go through the whole grid
/// in packets, without bricks.

#include "src/cpu/kernels/kernels.h"
#include "src/optics/slab_table.h"
#include "tetravox/grid.h"

#include <cstdint>
#include <span>

namespace tetravox::cpu {

/// Ray integrals of slabs as thick as two samples are apart, made again when distance or tolerance change, when it is
/// first asked where slabs are seen, and for a new function, after `invalidate`.
class SlabCache {
 public:
  static constexpr std::size_t kBytes =
      sizeof(float[4]) * optics::SlabTable::kEntries + optics::SlabTable::kCenterBytes;

  /// `range`: of the stored scalars. `tables`: those of the frame, of which the integrals are taken. `wants_centers`:
  /// where slabs are seen is to be found, too (`tables.effects` is filled).
  const optics::SlabTable& prepare(const ValueRange& range, const IntegratorTables& tables, const Kernels& kernels,
                                   float thickness, bool wants_centers);
  void invalidate() { thickness_ = 0.0f; }
  std::size_t bytes() const { return table_.bytes(); }

 private:
  optics::SlabTable table_;
  float thickness_ = 0.0f, tolerance_ = 0.0f;
};

/// What the packets of all tiles share.
class GridPackets {
 public:
  using March = std::uint64_t (*)(const PacketJob& job);

  /// `seen_spans`: see scene::list_seen_spans; it and `grid` must outlive this. `march`: the kernel that integrates
  /// segments one by one. `job`: what the rays of the frame would do in bricks.
  GridPackets(const PreparedGrid& grid, std::span<const std::uint8_t> seen_spans, March march, const MarchJob& job);

  /// Looks slabs up instead, by the kernel `march`.
  void use_slabs(const optics::SlabTable& slabs, March march);

  /// What light asks for: central differences, or gradients of the trilinear field; and the opacity of a step that is
  /// not worth one.
  void use_light(bool has_central_gradients, float faint) {
    job_.has_central_gradients = has_central_gradients;
    job_.faint = faint;
  }

  /// Draws the rays of the tile that has its corner in this pixel; returns how many segments they had.
  std::uint64_t draw(MarchRays& rays, int column, int row) const;

 private:
  March march_;
  MarchValues values_;
  IntegratorTables tables_;
  std::span<const std::uint8_t> seen_spans_;  // [bricks]
  PacketJob job_;
};

}  // namespace tetravox::cpu
