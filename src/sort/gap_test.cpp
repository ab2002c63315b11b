#include "src/sort/gap_test.h"

#include "src/sort/cell_interval.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tetravox::sort {
namespace {

/// Rounding of vertices to float moves a face by less than this, local units.
constexpr double kSeamWidth = 3e-7;

double turn(const Point2& a, const Point2& b, const Point2& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Whether all of `points` are outside one edge of the counter-clockwise `polygon`, or less than `width` inside.
bool is_beside(std::span<const Point2> polygon, std::span<const Point2> points, double width) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& a = polygon[i];
    const Point2& b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double length = std::abs(b.x - a.x) + std::abs(b.y - a.y);
    if (length <= 10.0 * width) continue;  // has no direction to rely on
    if (std::all_of(points.begin(), points.end(), [&](const Point2& p) { return turn(a, b, p) <= width * length; }))
      return true;
  }
  return false;
}

struct Triangle {
  std::array<Vector3, 3> corners;
  Vector3 normal;  ///< out of the cell, not of unit length
  double length = 0.0;

  Triangle(const PreparedMesh& mesh, const BoundaryFace& face) {
    for (std::size_t i = 0; i < 3; ++i) corners[i] = position_of(mesh.vertices[face.vertices[i]]);
    normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    length = norm(normal);
  }
};

/// Heights of the corners of one triangle over the plane of another.
struct Heights {
  double least = 0, greatest = 0;
  double rounding = 0;  ///< that they may have
};

Heights measure_heights(const Triangle& plane, const Triangle& triangle) {
  Heights heights{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest(), 0.0};
  const double edges = norm1(plane.corners[1] - plane.corners[0]) * norm1(plane.corners[2] - plane.corners[0]);
  for (const Vector3& corner : triangle.corners) {
    const Vector3 arm = corner - plane.corners[0];
    const double height = dot(plane.normal, arm) / plane.length;
    heights.least = std::min(heights.least, height);
    heights.greatest = std::max(heights.greatest, height);
    heights.rounding = std::max(heights.rounding, 4e-15 * edges * norm1(arm) / plane.length);
  }
  return heights;
}

/// The common part of two polygons of at most 8 corners.
struct Overlap {
  std::array<Point2, 16> points{};
  std::size_t count = 0;

  Point2 middle() const {
    Point2 sum;
    for (std::size_t i = 0; i < count; ++i) {
      sum.x += points[i].x;
      sum.y += points[i].y;
    }
    const auto n = static_cast<double>(count);
    return {sum.x / n, sum.y / n};
  }
};

/// Sutherland and Hodgman 1974.
Overlap intersect(std::span<const Point2> a, std::span<const Point2> b) {
  Overlap overlap;
  overlap.count = a.size();
  std::copy(a.begin(), a.end(), overlap.points.begin());
  for (std::size_t i = 0; i < b.size() && overlap.count > 0; ++i) {
    const Point2 from = b[i], to = b[i + 1 < b.size() ? i + 1 : 0];
    const Overlap before = overlap;
    overlap.count = 0;
    for (std::size_t k = 0; k < before.count; ++k) {
      const Point2 p = before.points[k], q = before.points[k + 1 < before.count ? k + 1 : 0];
      const double turn_p = turn(from, to, p), turn_q = turn(from, to, q);
      if (turn_p >= 0.0) overlap.points[overlap.count++] = p;
      if ((turn_p >= 0.0) == (turn_q >= 0.0) || overlap.count == overlap.points.size()) continue;
      const double t = turn_p / (turn_p - turn_q);
      overlap.points[overlap.count++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
    }
  }
  return overlap;
}

/// Depth at which the ray through p meets the plane of a triangle.
double depth_at(const PicturePlane& plane, const Triangle& triangle, const Point2& p) {
  return dot(triangle.normal, triangle.corners[0] - plane.origin(p)) / dot(triangle.normal, plane.direction(p));
}

}  // namespace

bool GapTest::is_gap(const PicturePolygon& exit, const PicturePolygon& entry) const {
  const double width = picture_.smallest_width;
  if (exit.nearest > entry.farthest + kSeamWidth) return false;
  if (exit.lower.x + width >= entry.upper.x || entry.lower.x + width >= exit.upper.x ||
      exit.lower.y + width >= entry.upper.y || entry.lower.y + width >= exit.upper.y)
    return false;
  const BoundaryFace& exit_face = mesh_.boundary[exit.face];
  const BoundaryFace& entry_face = mesh_.boundary[entry.face];
  if (exit_face.cell == entry_face.cell) return false;
  const auto exit_points = picture_.points_of(exit), entry_points = picture_.points_of(entry);
  if (is_beside(exit_points, entry_points, width) || is_beside(entry_points, exit_points, width)) return false;

  // Where one lies on one side of the other's plane, this decides.
  const Triangle exit_triangle(mesh_, exit_face), entry_triangle(mesh_, entry_face);
  const Heights behind = measure_heights(exit_triangle, entry_triangle);
  if (behind.least >= -behind.rounding) return true;
  const Heights before = measure_heights(entry_triangle, exit_triangle);
  if (before.least >= -before.rounding) return true;
  const bool is_before_by_exit = behind.greatest <= behind.rounding;
  const bool is_before_by_entry = before.greatest <= before.rounding;
  if ((is_before_by_exit && behind.least > -kSeamWidth) || (is_before_by_entry && before.least > -kSeamWidth))
    return decide_by_cells(exit, entry);
  if (is_before_by_exit || is_before_by_entry) return false;
  return decide_by_depth(exit, entry);
}

bool GapTest::decide_by_depth(const PicturePolygon& exit, const PicturePolygon& entry) const {
  const Overlap overlap = intersect(picture_.points_of(exit), picture_.points_of(entry));
  if (overlap.count < 3) return false;
  const Triangle exit_triangle(mesh_, mesh_.boundary[exit.face]), entry_triangle(mesh_, mesh_.boundary[entry.face]);
  double difference = 0.0;
  for (std::size_t i = 0; i < overlap.count; ++i)
    difference += depth_at(picture_.plane, entry_triangle, overlap.points[i]) -
                  depth_at(picture_.plane, exit_triangle, overlap.points[i]);
  difference /= static_cast<double>(overlap.count);
  if (std::abs(difference) > kSeamWidth) return difference > 0.0;
  return decide_by_cells(exit, entry);
}

bool GapTest::decide_by_cells(const PicturePolygon& exit, const PicturePolygon& entry) const {
  const Overlap overlap = intersect(picture_.points_of(exit), picture_.points_of(entry));
  if (overlap.count < 3) return false;
  const Point2 p = overlap.middle();
  const PicturePlane& plane = picture_.plane;
  const auto interval_of = [&](std::uint32_t face) {
    const auto corners = corners_of(mesh_, cells_[mesh_.boundary[face].cell]);
    constexpr double kFar = std::numeric_limits<double>::max();
    return intersect_cell(corners, plane.origin(p), plane.direction(p), plane.is_orthographic ? -kFar : 0.0, kFar);
  };
  const Interval first = interval_of(exit.face), second = interval_of(entry.face);
  // The cell that is entered may also lie wholly in front: then this pair says nothing.
  if (second.end <= first.begin) return false;
  return first.begin + first.end < second.begin + second.end;
}

}  // namespace tetravox::sort
