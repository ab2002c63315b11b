#pragma once

/// The field of a grid in double precision: values, where they lie, and how the field between them is reconstructed.
///
/// Written apart from src/grid on purpose, so that the two can be held against each other. Slow and simple.

#include "tests/reference/vectors.h"
#include "tetravox/dataset.h"
#include "tetravox/grid.h"

#include <array>
#include <cstddef>
#include <vector>

namespace tetravox::reference {

/// Where the values of a grid lie, and its reconstruction. Lattice coordinates are those of the shape before its
/// direction matrix and origin: world = origin + direction * lattice.
///
/// With kNearest, and with kLinear for cell data, the field is constant around (inside) each value: a cell of the
/// lattice is the box where it is so, and there are as many cells as values. Otherwise values lie at the cells'
/// corners: cell i lies between values i and i + 1, and kernels act on the index, which is linear in the coordinate
/// inside a cell.
struct Lattice {
  Vec origin{};
  std::array<Vec, 3> lattice_from_world{};   ///< rows
  std::array<std::size_t, 3> counts{};       ///< values along i, j, k
  std::array<std::vector<double>, 3> knots;  ///< borders of the cells, ascending
  bool is_constant = false;                  ///< in each cell
  Filter filter;

  Vec to_lattice(const Vec& direction) const {
    return {dot(lattice_from_world[0], direction), dot(lattice_from_world[1], direction),
            dot(lattice_from_world[2], direction)};
  }
};

Lattice make_lattice(const GridData& grid, const Filter& filter);

/// The values to draw, [k][j][i]: the component or the length of all; NaN for what is not finite.
std::vector<double> make_values(const GridData& grid);

/// What kernels are applied to: the values themselves; with kInterpolatingBspline the B-spline's coefficients along
/// each axis in turn. A missing value ends a line of values there as the border does, and stays missing, so that
/// nothing of it gets into its neighbours.
std::vector<double> make_coefficients(const Lattice& lattice, std::vector<double> values);

using CellIndex = std::array<std::size_t, 3>;

/// What the field in one cell is made of: the coefficients within the kernel's reach. Beyond the border is the nearest
/// coefficient; with kInterpolatingBspline the mirrored one, so that the field goes through the outermost values too.
class CellField {
 public:
  explicit CellField(const Lattice& lattice);

  /// Takes in the coefficients about a cell. False where one is missing: the cell is transparent.
  bool load(const std::vector<double>& coefficients, const CellIndex& cell);

  /// The field at a place inside the cell, each fraction in [0, 1].
  double eval(const Vec& fraction) const;

  /// True where all the coefficients are the same.
  bool is_flat() const { return low_ == high_; }
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  std::size_t index_beyond_border(int axis, std::ptrdiff_t index) const;

  const Lattice& lattice_;
  int width_ = 1;  ///< coefficients along each axis
  std::vector<double> block_;
  double low_ = 0.0, high_ = 0.0;
};

}  // namespace tetravox::reference
