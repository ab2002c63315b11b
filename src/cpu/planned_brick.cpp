#include "src/cpu/planned_brick.h"

namespace tetravox::cpu {

void fill_planned(const PlannedGrid& grid, std::uint32_t index, BrickLattice& lattice, MarchBrick& brick) {
  if (scene::is_group(*grid.sources.grid, index)) return lattice.fill_group(grid.field, brick);
  const ValueRange range = range_of(grid.sources, index);
  brick.steepness =
      grid.sources.steepness->largest_steepness(static_cast<float>(range.min), static_cast<float>(range.max));
  // A kernel reaches into other bricks.
  brick.has_missing |= grid.field.kernel && grid.sources.grid->missing_values > 0;
  lattice.fill(grid.field, brick);
  if (!grid.plans[index].is_curved) brick.steepness = 0.0f;
}

const MarchBrick& BrickStore::find(const PlannedGrid& grid, std::uint32_t index) {
  if (kept_.empty()) kept_.resize(kSlots);
  // Multiplied by the golden ratio, neighbours along all axes are spread (Knuth 1973, section 6.4).
  const std::size_t slot = (index * 0x9E3779B1u) >> 20;
  static_assert(kSlots == 1u << 12);
  if (kept_[slot].index == index) return kept_[slot].brick;
  if (bytes_ > kMostBytes) {
    kept_.clear();  // and what the bricks hold
    kept_.resize(kSlots);
    bytes_ = 0;
  }
  Kept& kept = kept_[slot];
  bytes_ -= kept.bytes();
  MarchBrick brick = lattice_.describe(*grid.sources.grid, *grid.frame, index, grid.plans[index].level);
  fill_planned(grid, index, lattice_, brick);
  copy(brick, kept);
  kept.index = index;
  bytes_ += kept.bytes();
  return kept.brick;
}

/// Without what kernels need behind the end.
void BrickStore::copy(const MarchBrick& brick, Kept& kept) {
  const auto [nx, ny, nz] =
      std::array<std::size_t, 3>{static_cast<std::size_t>(brick.cells[0]), static_cast<std::size_t>(brick.cells[1]),
                                 static_cast<std::size_t>(brick.cells[2])};
  kept.brick = brick;
  if (brick.constants)
    kept.values.assign(brick.constants, brick.constants + nx * ny * nz);
  else
    kept.values.assign(brick.records, brick.records + 4 * nx * ny * (nz + 1));
  kept.brick.constants = brick.constants ? kept.values.data() : nullptr;
  kept.brick.records = brick.records ? kept.values.data() : nullptr;
  kept.gradients.clear();
  if (brick.gradients) {
    const std::size_t places = brick.constants ? nx * ny * nz : (nx + 1) * (ny + 1) * (nz + 1);
    kept.gradients.assign(brick.gradients, brick.gradients + 4 * places);
    kept.brick.gradients = kept.gradients.data();
  }
  for (std::size_t axis = 0; axis < 3 && brick.is_uneven; ++axis) {
    kept.planes[axis].assign(brick.planes[axis], brick.planes[axis] + brick.cells[axis] + 1);
    kept.brick.planes[axis] = kept.planes[axis].data();
  }
}

}  // namespace tetravox::cpu
