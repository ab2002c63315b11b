#pragma once

/// Where a ray is inside a cell.

#include "src/sort/sorted_cells.h"
#include "src/sort/view_point.h"

#include <algorithm>

namespace tetravox::sort {

struct Interval {
  double begin = 0, end = 0;  ///< empty where end <= begin

  double length() const { return end - begin; }
};

/// Places origin + t * direction inside the tetrahedron with these corners, for t in [least, greatest]: between four
/// planes, each facing away from the corner that is opposite, however the cell is oriented.
inline Interval intersect_cell(const std::array<Vector3, 4>& corners, const Vector3& origin, const Vector3& direction,
                               double least, double greatest) {
  Interval interval{least, greatest};
  for (std::size_t rank = 0; rank < 4; ++rank) {
    const Vector3& a = corners[(rank + 1) & 3];
    Vector3 normal = cross(corners[(rank + 2) & 3] - a, corners[(rank + 3) & 3] - a);
    if (dot(normal, corners[rank] - a) > 0.0) normal = normal * -1.0;
    const double height = dot(normal, origin - a), slope = dot(normal, direction);
    if (slope > 0.0)
      interval.end = std::min(interval.end, -height / slope);
    else if (slope < 0.0)
      interval.begin = std::max(interval.begin, -height / slope);
    else if (height > 0.0)
      return {0.0, 0.0};
  }
  return interval;
}

inline std::array<Vector3, 4> corners_of(const PreparedMesh& mesh, const SortedCell& cell) {
  std::array<Vector3, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = position_of(mesh.vertices[cell.ids[i]]);
  return corners;
}

}  // namespace tetravox::sort
