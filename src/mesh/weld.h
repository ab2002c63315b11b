#pragma once

/// Points of a file -> vertices: points that coincide and carry the same values become one, in space-filling order.

#include "src/mesh/buffer.h"
#include "src/mesh/progress_meter.h"
#include "src/mesh/space_filling_order.h"
#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::mesh {

/// What became of a point.
struct PointTarget {
  std::uint32_t vertex;     ///< its vertex; kNoCell when no kept cell has the point
  std::uint32_t canonical;  ///< lowest id of the points at the same place, whatever their values
};

struct Weld {
  Buffer<PointTarget> targets;                 ///< [points]
  std::vector<std::uint32_t> point_of_vertex;  ///< [vertices]: the lowest of the points that a vertex stands for
  std::uint64_t merged_points = 0;
};

/// Bounds of the used points, world units.
/// @throws Error (kBadFile) with the lowest used point that has a coordinate which is not finite.
std::array<ValueRange, 3> bounds_of_used_points(const MeshData& mesh, const Buffer<std::uint8_t>& is_used);

/// Welds the used points exactly: coordinates equal (-0 is 0), and the values of all fields too with point data.
/// Vertices are numbered along a Hilbert curve. Deterministic.
Weld weld_points(const MeshData& mesh, const Buffer<std::uint8_t>& is_used, const std::array<ValueRange, 3>& bounds,
                 ProgressMeter& meter);

}  // namespace tetravox::mesh
