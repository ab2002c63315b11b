#pragma once

/// One cell -> tetrahedra, by pulling (Dompierre, Labbe, Vallet, Camarero 1999).
///
/// Every polygon is split as a fan around its lowest point and every polygon that does not contain the cell's lowest
/// point is joined to that one. "Lowest" goes by a canonical id that coincident points have in common, so that the
/// same polygon is split in the same way wherever it occurs. We differ from the paper in that a hexahedron always
/// gives six tetrahedra, and that polyhedra and the parts of quadratic cells are treated alike.

#include "src/mesh/cell_table.h"
#include "tetravox/dataset.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace tetravox::mesh {

/// What is wrong with a cell's entry in the connectivity.
enum class CellProblem { kNone, kUnknownType, kTooShort, kPointId, kFaceStream };

/// Checks a cell's entry: length, ids below `point_count`, a polyhedron's face stream.
CellProblem check_cell(CellType type, std::span<const std::uint32_t> entry, std::size_t point_count);

/// Upper bound of the tetrahedra of one cell. `entry` need not be valid.
std::uint64_t max_tetrahedra(CellType type, std::span<const std::uint32_t> entry);

/// Calls `visit(point)` for the points that the cell is made of (repeatedly for a polyhedron's). `entry` is valid.
template <class Visit>
void for_each_point(CellType type, std::span<const std::uint32_t> entry, const Visit& visit) {
  const int count = type == CellType::kTetrahedron ? 4 : cell_table(type).node_count;
  for (int i = 0; i < count; ++i) visit(entry[i]);
  if (type != CellType::kPolyhedron) return;
  std::size_t at = 1;
  for (std::uint32_t face = 0; face < entry[0]; ++face) {
    const std::uint32_t corners = entry[at++];
    for (std::uint32_t i = 0; i < corners; ++i) visit(entry[at++]);
  }
}

inline constexpr std::uint32_t kNoApex = std::numeric_limits<std::uint32_t>::max();

/// Joins one polygon of `count` corners to `apex`; corner i has the point `point(i)` and the canonical id `key(i)`.
/// A polygon that contains the canonical id `apex_key` is skipped.
template <class Point, class Key, class Emit>
void pull_face(std::size_t count, const Point& point, const Key& key, std::uint32_t apex, std::uint32_t apex_key,
               Emit& emit) {
  std::size_t lowest = 0;
  std::uint32_t lowest_key = key(0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t k = key(i);
    if (k == apex_key) return;
    if (k < lowest_key) {
      lowest = i;
      lowest_key = k;
    }
  }
  const auto next = [count](std::size_t i) { return i + 1 == count ? 0 : i + 1; };
  std::size_t a = next(lowest);
  for (std::size_t i = 2; i < count; ++i) {
    const std::size_t b = next(a);
    emit(point(lowest), point(a), point(b), apex);
    a = b;
  }
}

/// Splits the polyhedron of a face stream.
template <class Canonical, class Emit>
void decompose_polyhedron(std::span<const std::uint32_t> entry, const Canonical& canonical, Emit& emit) {
  std::uint32_t apex = 0, apex_key = kNoApex;
  for_each_point(CellType::kPolyhedron, entry, [&](std::uint32_t point) {
    const std::uint32_t key = canonical(point);
    if (key >= apex_key) return;
    apex = point;
    apex_key = key;
  });
  std::size_t at = 1;
  for (std::uint32_t face = 0; face < entry[0]; ++face) {
    const std::uint32_t corners = entry[at++];
    const std::uint32_t* points = entry.data() + at;
    pull_face(
        corners, [points](std::size_t i) { return points[i]; },
        [&canonical, points](std::size_t i) { return canonical(points[i]); }, apex, apex_key, emit);
    at += corners;
  }
}

/// Calls `emit(p0, p1, p2, p3)` with the point ids of each tetrahedron of a valid cell, in no particular orientation;
/// some may be degenerate. `canonical(point)` is below 2^32 - 1.
template <class Canonical, class Emit>
void decompose(CellType type, std::span<const std::uint32_t> entry, const Canonical& canonical, Emit&& emit) {
  if (type == CellType::kTetrahedron) return emit(entry[0], entry[1], entry[2], entry[3]);
  if (type == CellType::kPolyhedron) return decompose_polyhedron(entry, canonical, emit);
  const CellTable& table = cell_table(type);
  std::array<std::uint32_t, kLargestNodeCount> keys;
  for (int i = 0; i < table.node_count; ++i) keys[i] = canonical(entry[i]);
  for (const CellPart& part : table.parts) {
    // Find the point that everything is joined to. A given apex lies inside, on none of the faces.
    int apex = part.apex;
    if (apex < 0) {
      apex = part.nodes[0];
      for (const std::uint8_t node : part.nodes)
        if (keys[node] < keys[apex]) apex = node;
    }
    const std::uint32_t apex_key = part.apex < 0 ? keys[apex] : kNoApex;
    for (const CellFace& face : part.faces)
      pull_face(
          static_cast<std::size_t>(face.count), [&](std::size_t i) { return entry[face.nodes[i]]; },
          [&](std::size_t i) { return keys[face.nodes[i]]; }, entry[apex], apex_key, emit);
  }
}

}  // namespace tetravox::mesh
