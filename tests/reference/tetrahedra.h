#pragma once

/// Any mesh of linear cells -> a plain list of tetrahedra, in double precision: the exact field that pictures show.
///
/// Written apart from src/mesh on purpose, so that the two can be held against each other. Slow and simple.

#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::reference {

struct Tetrahedron {
  std::array<std::uint32_t, 4> vertices{};
  std::uint32_t input_cell = 0;  ///< cell of the mesh that it is part of
};

/// Tetrahedra with their field; cells with a missing value are left out, flat ones too.
struct Tetrahedra {
  std::vector<std::array<double, 3>> points;  ///< world coordinates
  std::vector<double> point_scalars;          ///< [points] with point data, otherwise empty
  std::vector<double> cell_scalars;           ///< [input cells] with cell data, otherwise empty
  std::vector<Tetrahedron> cells;
};

/// Splits linear cells by pulling: a face is a fan about its lowest point, a cell the cone over its faces from its
/// lowest point (Dompierre, Labbe, Vallet, Camarero 1999). Points that coincide, with equal values, count as the first
/// of them.
/// @throws Error (kUnsupported) for quadratic cells, (kBadFile) for a cell with too few points.
Tetrahedra make_tetrahedra(const MeshData& mesh);

}  // namespace tetravox::reference
