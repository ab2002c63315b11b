#pragma once

/// Any mesh of cells -> conforming tetrahedra that rays can walk through.
///
/// A `PreparedMesh` is made once for a dataset and does not depend on camera or transfer function. It is 20 bytes
/// a tetrahedron (24 with cell data) and 16 bytes a vertex (a renderer adds 16 for the camera's frame), plus the
/// boundary.

#include "tetravox/dataset.h"
#include "tetravox/progress.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox {

/// "No cell": the neighbour beyond the boundary. Also no valid vertex or cell id.
inline constexpr std::uint32_t kNoCell = 0xFFFFFFFFu;

/// A vertex in the mesh's local frame with its stored scalar.
struct Vertex {
  float x = 0, y = 0, z = 0;
  float scalar = 0;  ///< stored scalar, see `PreparedMesh::scalar_offset`; unused with cell data
};
static_assert(sizeof(Vertex) == 16);

/// A tetrahedron, known by what a ray needs that enters it through a face whose three vertices it already knows.
struct TetrahedronLinks {
  std::uint32_t vertex_xor = 0;  ///< v0 ^ v1 ^ v2 ^ v3: three known vertices give the fourth
  std::array<std::uint32_t, 4>
      neighbours{};  ///< [r]: cell (or kNoCell) across the face opposite the vertex with the r-th smallest id
};
static_assert(sizeof(TetrahedronLinks) == 20);

/// A boundary face. Seen from outside, v[0], v[1], v[2] run counter-clockwise: (v1 - v0) x (v2 - v0) points out of the
/// cell.
struct BoundaryFace {
  std::uint32_t cell = kNoCell;
  std::array<std::uint32_t, 3> vertices{};
};
static_assert(sizeof(BoundaryFace) == 16);

/// What preparing met and did, for `info` and for statistics.
struct PrepareReport {
  std::uint64_t input_cells = 0;
  std::uint64_t tetrahedra = 0;
  std::uint64_t merged_points = 0;        ///< points that coincide exactly, with equal values, and became one
  std::uint64_t degenerate = 0;           ///< tetrahedra without volume, left out
  std::uint64_t missing_value_cells = 0;  ///< input cells with a corner (or value) that is not finite, left out
  std::uint64_t duplicated = 0;           ///< tetrahedra that occur twice, left out
  std::uint64_t overlapping_faces =
      0;  ///< faces with more than two cells or two cells on one side; treated as boundary
  std::uint64_t boundary_faces = 0;
};

/// A further field, stored like the first.
struct OtherScalars {
  std::vector<float> scalars;  ///< [vertices], or [cells] with cell data
  double offset = 0.0, scale = 1.0;
  ValueRange range;  ///< of the values
};

/// Tetrahedra with adjacency, in space-filling order. Immutable once made; safe to read from many threads.
///
/// Frames: world = origin + local * world_per_local, with `origin` the middle of the bounds, so that |local| <= 1:
/// a mesh far from the origin, or tiny, or huge, loses nothing to float.
/// Scalars: value = scalar_offset + stored * scalar_scale (a power of two), chosen likewise.
struct PreparedMesh {
  std::vector<Vertex> vertices;
  std::vector<TetrahedronLinks> cells;
  std::vector<float> cell_scalars;  ///< [cells] with cell data, otherwise empty
  std::vector<BoundaryFace> boundary;

  std::array<double, 3> origin{};
  double world_per_local = 1.0;
  double scalar_offset = 0.0;
  double scalar_scale = 1.0;
  ValueRange scalar_range;           ///< of the values drawn (not of the stored scalars)
  std::vector<OtherScalars> others;  ///< of `MeshData::others`
  std::array<ValueRange, 3> bounds;  ///< world units, of the cells drawn
  Association association = Association::kPoint;
  PrepareReport report;
};

/// Bytes that `prepare_mesh` holds at its peak for `mesh` (input not counted), and bytes of what it returns. Upper
/// estimates.
struct MemoryEstimate {
  std::uint64_t peak = 0;
  std::uint64_t resident = 0;
};
MemoryEstimate estimate_prepare_memory(const MeshData& mesh);

/// Splits every cell into tetrahedra that conform across cells, orients and orders them, finds neighbours and boundary.
///
/// Quadrilaterals are split from their lowest point, cells joined to their lowest point ("pulling": Dompierre, Labbe,
/// Vallet, Camarero 1999); quadratic cells are first split at their mid-edge nodes. Points that coincide exactly
/// and carry equal values in all fields become one; a cell that lacks a value of any field is left out. Degenerate,
/// inverted, duplicated and overlapping cells are made harmless and counted. Deterministic: the same bytes for any
/// number of threads.
/// @throws Error: kBadFile for ids or offsets out of range, kNothingToDraw when no cell is left (says why),
/// kOutOfMemory,
///         kUnsupported above 2^32 - 2 tetrahedra, kCancelled.
PreparedMesh prepare_mesh(const MeshData& mesh, const Progress& progress = {});

}  // namespace tetravox
