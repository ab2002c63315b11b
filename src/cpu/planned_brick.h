#pragma once

/// Lattices of bricks as their plans ask, and a store of them for those who come back to the same bricks.

#include "src/cpu/brick_lattice.h"
#include "src/cpu/kernels/kernels.h"
#include "src/grid/frame.h"
#include "src/scene/brick_plan.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::cpu {

/// A grid as a frame draws it. Views everything.
struct PlannedGrid {
  const grid::GridFrame* frame = nullptr;
  LatticeField field;
  scene::PlanSources sources;
  std::span<const scene::BrickPlan> plans;
};

/// Reads the values of a brick that `lattice` has described last into it, and points `brick` at them.
void fill_planned(const PlannedGrid& grid, std::uint32_t index, BrickLattice& lattice, MarchBrick& brick);

/// Keeps bricks: of one thread.
class BrickStore {
 public:
  /// Bytes that a thread keeps at most, about.
  static constexpr std::size_t kMostBytes = std::size_t{256} << 20;
  /// Of a brick without a filter.
  static constexpr std::size_t kBytesOfBrick = 4 * kBrickCells * kBrickCells * (kBrickCells + 1) * sizeof(float);

  /// Valid until the next call.
  const MarchBrick& find(const PlannedGrid& grid, std::uint32_t index);

 private:
  struct Kept {
    std::uint32_t index = 0xFFFFFFFFu;
    MarchBrick brick;
    std::vector<float> values, gradients;
    std::array<std::vector<float>, 3> planes;

    std::size_t bytes() const { return (values.size() + gradients.size()) * sizeof(float); }
  };

  static constexpr std::size_t kSlots = 4096;

  static void copy(const MarchBrick& brick, Kept& kept);

  BrickLattice lattice_;
  std::vector<Kept> kept_;
  std::size_t bytes_ = 0;
};

}  // namespace tetravox::cpu
