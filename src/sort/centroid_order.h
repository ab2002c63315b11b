#pragma once

/// Cells by the distance of their centroids.

#include "src/sort/sorted_cells.h"
#include "src/sort/view_point.h"
#include "tetravox/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::sort {

/// Distances as whole numbers that order alike, and the buffers of a radix sort.
struct CentroidBuffers {
  std::vector<std::uint64_t> pairs, other_pairs;  ///< key << 32 | cell

  std::uint64_t bytes() const { return (pairs.capacity() + other_pairs.capacity()) * sizeof(std::uint64_t); }
};

/// Centroid of a cell, local; of an unknown cell the origin.
Vector3 centroid_of(const PreparedMesh& mesh, const SortedCell& cell);

/// Fills `order` with all cells, the farthest centroid first, equal ones by id: a radix sort from the least digit, in
/// parallel, the same for any number of threads.
///
/// Of a perspective camera the distance is that to the eye, not that along the line of sight: it is what grows along
/// every ray, and does not change when the camera turns.
void sort_by_centroids(const PreparedMesh& mesh, std::span<const SortedCell> cells, const ViewPoint& view,
                       CentroidBuffers& buffers, std::vector<std::uint32_t>& order);

}  // namespace tetravox::sort
