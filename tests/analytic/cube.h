#pragma once

/// The cube [-1, 1]^3 as a mesh or a grid: what the pictures with effects are held against.

#include "tests/common/body.h"
#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"
#include "tetravox/transfer_function.h"

#include <cstdint>

namespace tetravox::analytic {

inline const Vector3 kLower{-1, -1, -1};
inline const Vector3 kUpper{1, 1, 1};
inline const Color kColor{0.9, 0.6, 0.3};
inline constexpr double kExtinction = 1.3;
inline const OpticalFunction kHomogeneous{{{0.0, kExtinction, kColor}}};

/// `cells`: along each side; tetrahedra, six for each.
inline tests::Body make_cube(bool is_grid, int cells, const tests::Field& field) {
  if (is_grid) {
    tests::GridOptions options;
    const auto points = static_cast<std::uint32_t>(cells + 1);
    options.dimensions = {points, points, points};
    return tests::make_grid(options, field);
  }
  tests::BoxOptions options;
  options.bricks = {cells, cells, cells};
  options.type = CellType::kTetrahedron;
  return tests::make_box(options, field);
}

}  // namespace tetravox::analytic
