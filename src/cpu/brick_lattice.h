#pragma once

/// A brick's values as the marcher wants them: small enough to stay in the cache.

#include "src/cpu/brick_gradients.h"
#include "src/cpu/kernels/kernels.h"
#include "src/grid/frame.h"
#include "src/grid/separable_kernel.h"
#include "src/grid/values.h"
#include "src/optics/antiderivative_table.h"
#include "src/scene/kernel_lattice.h"
#include "tetravox/grid.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::cpu {

/// Where lattices come from, and how they are made: shared by all threads.
struct LatticeField {
  const Kernels* kernels = nullptr;
  const grid::BlockReader* reader = nullptr;
  std::int64_t padding = 0;                           ///< places of the reader before the grid's first value
  const grid::SeparableKernel* kernel = nullptr;      ///< null: the values themselves
  int most_parts = 8;                                 ///< that a cell is divided into for it, along each axis
  const optics::ControlPointTable* points = nullptr;  ///< set for pre-classification: densities instead of scalars
  bool is_constant = false;                           ///< constant cells
  bool is_nearest = false;                            ///< of them: eighths of cells, each with the value of its corner
  float allowed_rate = 0.0f;                          ///< see MarchJob
  GradientSource gradients = GradientSource::kNone;
  DifferenceField differences;  ///< of the values, for `kCentral`
};

/// Memory of one lattice at a time, used again and again.
class BrickLattice {
 public:
  /// Box, cells and flags of a brick (or a group, see scene/brick_groups.h) whose lattice cells are 2^level cells a
  /// side; no values yet.
  MarchBrick describe(const PreparedGrid& grid, const grid::GridFrame& frame, std::uint32_t brick, int level);

  /// Asks for the values of a brick that comes next.
  static void prefetch(const LatticeField& field, const PreparedGrid& grid, std::uint32_t brick);

  /// Reads the values of the brick described last, and points `brick` at them. With a kernel the cells are divided
  /// until the trilinear lattice is as near to the filtered field as `brick.steepness` asks, at most into
  /// `most_parts` along each axis, and at least into `least_parts`. Returns into how many.
  int fill(const LatticeField& field, MarchBrick& brick, int least_parts = 1);

  /// The same for a group that is a single cell: between the values at its corners.
  void fill_group(const LatticeField& field, MarchBrick& brick);

 private:
  void place_planes(MarchBrick& brick, int parts);
  void spread_values(MarchBrick& brick);
  void divide_cells(int parts, MarchBrick& brick);
  int filter_values(const LatticeField& field, MarchBrick& brick, int least_parts);
  void filter_densities(const LatticeField& field, MarchBrick& brick);
  void fill_gradients(const LatticeField& field, const grid::Block& values, int parts, MarchBrick& brick);
  void filter_gradients(const LatticeField& field, int parts, const MarchBrick& brick);
  void rescale_gradients(int axis, int parts);
  void fill_records(const Kernels& kernels, const MarchBrick& brick);
  void fill_densities(const optics::ControlPointTable& points, const MarchBrick& brick);

  grid::Block block_;  ///< nodes in `values_`
  std::int64_t stride_ = 1;
  std::vector<float> values_, records_;
  std::array<std::vector<float>, 3> cell_planes_, planes_;  ///< of an uneven brick: as it is, and divided
  scene::KernelLattice filtered_;
  std::vector<float> margin_;  // scratch
  std::vector<float> gradients_, coarse_gradients_;
};

}  // namespace tetravox::cpu
