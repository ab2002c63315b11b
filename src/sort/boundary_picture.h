#pragma once

/// Boundary faces as polygons of a picture plane.

#include "src/sort/face_sides.h"
#include "src/sort/sorted_cells.h"
#include "src/sort/view_point.h"
#include "tetravox/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::sort {

struct Point2 {
  double x = 0, y = 0;
};

/// A plane that the boundary is projected to. right x up = -forward. Perspective: the point (x, y) is the ray from the
/// eye along forward + x right + y up, and depth is the distance along `forward`. Orthographic: the ray through
/// x right + y up along `forward`.
struct PicturePlane {
  Vector3 right{}, up{}, forward{};
  Vector3 eye{};  ///< 0 where orthographic
  bool is_orthographic = false;
  bool is_quarter = false;  ///< holds only the pyramid |x| <= 1, |y| <= 1

  Vector3 origin(const Point2& p) const { return is_orthographic ? right * p.x + up * p.y : eye; }
  Vector3 direction(const Point2& p) const { return is_orthographic ? forward : forward + right * p.x + up * p.y; }
};

/// A boundary face, or the part of it that is in the plane: convex, counter-clockwise.
struct PicturePolygon {
  Point2 lower, upper;
  double nearest = 0, farthest = 0;  ///< depth
  std::uint32_t face = 0;            ///< of PreparedMesh::boundary
  std::uint32_t first = 0;           ///< in BoundaryPicture::points
  std::uint32_t count = 0;
};

/// Faces through which rays leave the mesh, and through which they enter it. Those that are seen edge-on are left out.
struct BoundaryPicture {
  PicturePlane plane;
  std::vector<Point2> points;
  std::vector<PicturePolygon> exits, entries;
  double smallest_width = 0.0;  ///< narrower overlaps are rounding

  std::span<const Point2> points_of(const PicturePolygon& polygon) const {
    return std::span(points).subspan(polygon.first, polygon.count);
  }
};

/// The planes that together hold all rays which meet the mesh: one where the mesh, within `radius` of the local origin,
/// is on one side of the eye, otherwise six round the eye.
std::vector<PicturePlane> choose_planes(const ViewPoint& view, double radius);

/// The boundary in one plane. In parallel; the same for any number of threads.
BoundaryPicture project_boundary(const PreparedMesh& mesh, std::span<const SortedCell> cells,
                                 std::span<const CellSides> sides, const PicturePlane& plane);

}  // namespace tetravox::sort
