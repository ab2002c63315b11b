#pragma once

/// What functions of several variables ask of a grid beside the value drawn.

#include "src/cpu/brick_lattice.h"
#include "src/cpu/domain.h"
#include "src/grid/frame.h"
#include "src/grid/values.h"
#include "src/scene/brick_plan.h"
#include "src/scene/filtered_field.h"
#include "tetravox/grid.h"
#include "tetravox/multidimensional.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::cpu {

/// The lattices of a brick that a thread works with.
struct BrickLattices {
  BrickLattice value;
  std::array<BrickLattice, kMostVariables> others;
};

/// A function and the further fields that it asks for. Not to be moved.
class GridDomain {
 public:
  /// Views the grid.
  explicit GridDomain(const PreparedGrid& grid) : grid_(grid) {}
  GridDomain(const GridDomain&) = delete;
  GridDomain& operator=(const GridDomain&) = delete;

  void clear() { set({}); }
  void set_table(const OpticalTable& table, const std::vector<std::size_t>& others);
  /// `function`: gives the extinction.
  void set_colors(std::size_t other, const OpticalFunction& colors, const OpticalFunction& function);

  const Domain& domain() const { return domain_; }
  bool is_set() const { return domain_.is_set(); }

  /// Makes what frames with these settings need.
  void prepare(const Filter& filter, double tolerance, double diagonal);
  /// For the kernels. Points into this.
  DomainFunction make_function(double tolerance, double diagonal) const {
    return make_domain_function(domain_, occupancy_, tolerance, diagonal);
  }
  /// How lattices of the further fields are filled; `field`: how those of the value are.
  std::vector<LatticeField> make_fields(const LatticeField& field) const;
  /// Of a table: whether it absorbs anywhere in what occurs in a brick, whatever the gradient. Views this.
  scene::IsSeen find_seen() const;

  /// What a brick is, and what its lattices are filled from.
  struct Filling {
    const PreparedGrid& drawn;
    const grid::GridFrame& frame;
    const LatticeField& field;
    const std::vector<LatticeField>& others;
    std::uint32_t brick = 0;
  };
  /// Reads the value and the further fields of a brick into lattices of the same cells, and points `brick` at them.
  void fill(const Filling& filling, BrickLattices& lattices, MarchBrick& brick) const;

  std::uint64_t bytes() const;

 private:
  /// A field that an axis of the function asks for.
  struct Other {
    Other(const PreparedGrid& prepared, std::size_t its_axis)
        : axis(its_axis), grid(&prepared), reader(prepared.data, {prepared.scalar_offset, prepared.scalar_scale}) {}

    const PreparedGrid& drawn() const { return field.middles ? *field.middles : *grid; }

    std::size_t axis;
    const PreparedGrid* grid;
    grid::BlockReader reader;
    scene::FilteredField field;
  };

  void set(Domain domain);
  DomainScalars scalars() const;

  const PreparedGrid& grid_;
  Domain domain_;
  TableOccupancy occupancy_;
  std::vector<Other> others_;
};

}  // namespace tetravox::cpu
