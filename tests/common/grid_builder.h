#pragma once

/// Small grids made in tests.

#include "tests/common/mesh_builder.h"
#include "tetravox/camera.h"
#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::tests {

/// A box of lattice points. The direction matrix turns (shears, mirrors) the box about its middle.
struct GridOptions {
  std::array<std::uint32_t, 3> dimensions{9, 8, 7};  ///< points
  Vector3 lower{-1, -1, -1};
  Vector3 upper{1, 1, 1};
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
  /// Uneven axes: [dimensions[a]], ascending from 0 (lower) to 1 (upper); empty: even.
  std::array<std::vector<double>, 3> fractions;
  ScalarType type = ScalarType::kFloat32;
  Association association = Association::kPoint;
};

inline constexpr ScalarType kAllScalarTypes[] = {
    ScalarType::kInt8,   ScalarType::kUint8, ScalarType::kInt16,  ScalarType::kUint16,  ScalarType::kInt32,
    ScalarType::kUint32, ScalarType::kInt64, ScalarType::kUint64, ScalarType::kFloat32, ScalarType::kFloat64};

/// A grid that owns its values: `field` at each value's place in the world. Integers are rounded and kept in the range
/// of their type.
GridData make_grid(const GridOptions& options, const Field& field);
/// The same with one component for each field, interleaved.
GridData make_vector_grid(const GridOptions& options, const std::vector<Field>& fields, int component);

/// World position of place (i, j, k) of the lattice: points at whole numbers, uneven axes linear in between.
Vector3 lattice_place(const GridShape& shape, const Vector3& index);

/// The grid with every point at centre + factor * p.
GridData transform_grid(GridData grid, double factor, const Vector3& centre);

/// `count` fractions from 0 to 1 whose steps grow from end to end, by `growth` in all.
std::vector<double> growing_fractions(std::uint32_t count, double growth);

/// Fields in [0, 1] over [-1, 1]^3.
/// Marschner and Lobb's (1994) test signal, `cycles` of its ripple along the side (theirs: 6).
double marschner_lobb(const Vector3& p, double cycles = 6.0);
/// A sum of plane waves of random directions and phases, up to `cycles` along the side, clamped.
Field make_random_field(std::uint32_t seed, double cycles);

}  // namespace tetravox::tests
