#include "src/sort/boundary_picture.h"

#include "src/support/threads.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace tetravox::sort {
namespace {

constexpr std::size_t kFacesPerChunk = 1 << 11;

/// Any two directions across `forward`.
PicturePlane make_plane(const Vector3& forward) {
  PicturePlane plane;
  plane.forward = forward;
  const int least = std::abs(forward[0]) < std::abs(forward[1]) ? (std::abs(forward[0]) < std::abs(forward[2]) ? 0 : 2)
                                                                : (std::abs(forward[1]) < std::abs(forward[2]) ? 1 : 2);
  Vector3 helper{};
  helper[least] = 1.0;
  plane.right = cross(forward, helper);
  plane.right = plane.right * (1.0 / norm(plane.right));
  plane.up = cross(plane.right, forward);
  return plane;
}

/// At most three corners and one more for each of four sides.
struct SmallPolygon {
  std::array<Vector3, 8> corners{};
  std::size_t count = 0;

  void add(const Vector3& corner) { corners[count++] = corner; }
};

/// The part where `height(corner)`, which is linear, is not below 0 (Sutherland and Hodgman 1974).
template <class Height>
SmallPolygon clip(const SmallPolygon& polygon, const Height& height) {
  SmallPolygon clipped;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vector3& a = polygon.corners[i];
    const Vector3& b = polygon.corners[(i + 1) % polygon.count];
    const double height_a = height(a), height_b = height(b);
    if (height_a >= 0.0) clipped.add(a);
    if ((height_a >= 0.0) != (height_b >= 0.0)) clipped.add(a + (b - a) * (height_a / (height_a - height_b)));
  }
  return clipped;
}

/// A little more than the pyramid |x| <= z, |y| <= z, so that nothing is lost between two of them.
void clip_to_quarter(SmallPolygon& polygon) {
  constexpr double kSlope = 1.0 + 1e-6;
  polygon = clip(polygon, [](const Vector3& p) { return kSlope * p[2] - p[0]; });
  polygon = clip(polygon, [](const Vector3& p) { return kSlope * p[2] + p[0]; });
  polygon = clip(polygon, [](const Vector3& p) { return kSlope * p[2] - p[1]; });
  polygon = clip(polygon, [](const Vector3& p) { return kSlope * p[2] + p[1]; });
}

class Projection {
 public:
  Projection(const PreparedMesh& mesh, std::span<const SortedCell> cells, std::span<const CellSides> sides,
             const PicturePlane& plane)
      : mesh_(mesh), cells_(cells), sides_(sides), plane_(plane) {}

  void add(std::uint32_t index, BoundaryPicture& picture) const {
    const BoundaryFace& face = mesh_.boundary[index];
    const Side side = sides_[face.cell][rank_of(face)];
    if (side == Side::kEdgeOn) return;
    SmallPolygon corners;
    for (const std::uint32_t vertex : face.vertices) {
      const Vector3 arm = position_of(mesh_.vertices[vertex]) - plane_.eye;
      corners.add({dot(arm, plane_.right), dot(arm, plane_.up), dot(arm, plane_.forward)});
    }
    // From the eye, a face is seen from its inner side where rays leave.
    if (side == Side::kBehind) std::swap(corners.corners[1], corners.corners[2]);
    if (plane_.is_quarter) clip_to_quarter(corners);
    if (corners.count < 3) return;
    auto& list = side == Side::kBehind ? picture.exits : picture.entries;
    list.push_back(make_polygon(corners, index, picture.points));
  }

 private:
  std::size_t rank_of(const BoundaryFace& face) const {
    const auto& v = face.vertices;
    const std::uint32_t apex = mesh_.cells[face.cell].vertex_xor ^ v[0] ^ v[1] ^ v[2];
    const auto ascending = cells_[face.cell].ascending();
    return static_cast<std::size_t>(std::find(ascending.begin(), ascending.end() - 1, apex) - ascending.begin());
  }

  PicturePolygon make_polygon(const SmallPolygon& corners, std::uint32_t index, std::vector<Point2>& points) const {
    PicturePolygon polygon;
    polygon.face = index;
    polygon.first = static_cast<std::uint32_t>(points.size());
    polygon.count = static_cast<std::uint32_t>(corners.count);
    for (std::size_t i = 0; i < corners.count; ++i) {
      const auto& [x, y, z] = corners.corners[i];
      const Point2 p = plane_.is_orthographic ? Point2{x, y} : Point2{x / z, y / z};
      points.push_back(p);
      const bool is_first = i == 0;
      polygon.lower = is_first ? p : Point2{std::min(polygon.lower.x, p.x), std::min(polygon.lower.y, p.y)};
      polygon.upper = is_first ? p : Point2{std::max(polygon.upper.x, p.x), std::max(polygon.upper.y, p.y)};
      polygon.nearest = is_first ? z : std::min(polygon.nearest, z);
      polygon.farthest = is_first ? z : std::max(polygon.farthest, z);
    }
    return polygon;
  }

  const PreparedMesh& mesh_;
  std::span<const SortedCell> cells_;
  std::span<const CellSides> sides_;
  const PicturePlane& plane_;
};

void append(BoundaryPicture& picture, const BoundaryPicture& part) {
  const auto shift = static_cast<std::uint32_t>(picture.points.size());
  picture.points.insert(picture.points.end(), part.points.begin(), part.points.end());
  const auto append_list = [shift](std::vector<PicturePolygon>& to, const std::vector<PicturePolygon>& from) {
    for (PicturePolygon polygon : from) {
      polygon.first += shift;
      to.push_back(polygon);
    }
  };
  append_list(picture.exits, part.exits);
  append_list(picture.entries, part.entries);
}

/// Widths that rounding of places can make, in this plane.
double find_smallest_width(const BoundaryPicture& picture) {
  double extent = 0.0;
  for (const auto* list : {&picture.exits, &picture.entries})
    for (const PicturePolygon& polygon : *list)
      extent = std::max({extent, std::abs(polygon.lower.x), std::abs(polygon.lower.y), std::abs(polygon.upper.x),
                         std::abs(polygon.upper.y)});
  return extent * (1e-13 + 1e-15 * norm(picture.plane.eye));
}

}  // namespace

std::vector<PicturePlane> choose_planes(const ViewPoint& view, double radius) {
  if (view.is_orthographic) {
    PicturePlane plane = make_plane(view.forward);
    plane.is_orthographic = true;
    return {plane};
  }
  constexpr double kFarEnough = 1.25;  // rays are then within 54 degrees
  std::vector<PicturePlane> planes;
  const double distance = norm(view.eye);
  if (distance > kFarEnough * radius) {
    planes.push_back(make_plane(view.eye * (-1.0 / distance)));
  } else {
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) {
        Vector3 forward{};
        forward[axis] = sign;
        planes.push_back(make_plane(forward));
        planes.back().is_quarter = true;
      }
  }
  for (PicturePlane& plane : planes) plane.eye = view.eye;
  return planes;
}

BoundaryPicture project_boundary(const PreparedMesh& mesh, std::span<const SortedCell> cells,
                                 std::span<const CellSides> sides, const PicturePlane& plane) {
  const Projection projection(mesh, cells, sides, plane);
  const std::size_t count = mesh.boundary.size();
  std::vector<BoundaryPicture> parts((count + kFacesPerChunk - 1) / kFacesPerChunk);
  support::parallel_chunks(parts.size(), 1, [&](std::size_t part, std::size_t last) {
    for (; part < last; ++part)
      for (std::size_t i = part * kFacesPerChunk; i < std::min(count, (part + 1) * kFacesPerChunk); ++i)
        projection.add(static_cast<std::uint32_t>(i), parts[part]);
  });
  BoundaryPicture picture;
  picture.plane = plane;
  for (const BoundaryPicture& part : parts) append(picture, part);
  picture.smallest_width = find_smallest_width(picture);
  return picture;
}

}  // namespace tetravox::sort
