#pragma once

/// Frames that lose nothing to float: local coordinates and stored scalars.

#include "src/mesh/tetrahedra.h"
#include "tetravox/dataset.h"
#include "tetravox/mesh.h"

#include <array>
#include <cstddef>
#include <span>

namespace tetravox::mesh {

/// value = offset + stored * scale.
struct ScalarFrame {
  double offset = 0.0;
  double scale = 1.0;  ///< a power of two

  float stored(double value) const { return static_cast<float>((value - offset) / scale); }
};

/// Bounds of the vertices of `list`, world units.
std::array<ValueRange, 3> bounds_of_vertices(const MeshData& mesh, const TetrahedronList& list);

/// Largest extent of `bounds` halved; finite for any finite bounds.
double half_extent(const std::array<ValueRange, 3>& bounds);

/// A field over the tetrahedra of a list: the value of vertex i, or of tetrahedron i with cell data.
struct ListedField {
  const TetrahedronList& list;
  Association association = Association::kPoint;
  std::span<const double> scalars;  ///< [points] or [cells] of the input

  std::size_t size() const { return association == Association::kPoint ? list.point_of_vertex.size() : list.count; }
  double value(std::size_t i) const {
    return scalars[association == Association::kPoint ? list.point_of_vertex[i] : list.tetrahedra[i].source];
  }
};

/// Range of the values drawn.
ValueRange scalar_range(const ListedField& field);

/// The middle of the range becomes 0 where the range is narrow compared with its distance from 0; otherwise 0 stays 0,
/// so that every value keeps its relative precision. The largest stored magnitude is about 1, or more (up to 2^60)
/// where nearly all values lie far below the largest, as beside a fill value.
ScalarFrame choose_scalar_frame(const ListedField& field, const ValueRange& range);

/// Sets frame, bounds, range, vertices, cell scalars and other fields of `prepared` from the vertices of `list`.
void write_vertices(const MeshData& mesh, const TetrahedronList& list, PreparedMesh& prepared);

}  // namespace tetravox::mesh
