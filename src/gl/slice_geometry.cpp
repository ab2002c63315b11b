#include "src/gl/slice_geometry.h"

#include "tetravox/error.h"
#include "tetravox/slicing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace tetravox::gl {
namespace {

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Point difference(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

HalfSpace reversed(const HalfSpace& h) { return {{-h.normal[0], -h.normal[1], -h.normal[2]}, -h.offset}; }

/// Points with t >= `t`, of planes.
HalfSpace from_on(const HalfSpace& plane, double t) { return {plane.normal, plane.offset - t}; }

/// Where the way from an inner to an outer point leaves: the same whichever face asks.
Point leave(const Point& inner, double d_inner, const Point& outer, double d_outer) {
  const double share = d_inner / (d_inner - d_outer);
  Point p{};
  for (int i = 0; i < 3; ++i) p[i] = inner[i] + share * (outer[i] - inner[i]);
  return p;
}

/// Points of a convex polygon in their order round it.
std::vector<Point> put_in_order(std::vector<Point> points, const Point& normal) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return {};
  Point middle{};
  for (const Point& p : points)
    for (int i = 0; i < 3; ++i) middle[i] += p[i] / static_cast<double>(points.size());
  const Point u = difference(points[0], middle), v = cross(normal, u);
  const auto angle = [&](const Point& p) {
    const Point d = difference(p, middle);
    return std::atan2(dot(d, v), dot(d, u) * std::sqrt(dot(normal, normal)));
  };
  std::sort(points.begin(), points.end(), [&](const Point& a, const Point& b) { return angle(a) < angle(b); });
  return points;
}

/// A place in the picture, pixels; rows count downwards.
using Pixel = std::array<double, 2>;

/// By how much polygons reach over what they cover: rasterizers round corners, to a 256th of a pixel or finer.
constexpr double kMargin = 1.0 / 64.0;

double turn(const Pixel& a, const Pixel& b, const Pixel& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The convex hull, counter-clockwise where rows count upwards (Andrew 1979).
std::vector<Pixel> find_hull(std::vector<Pixel> points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return {};
  std::vector<Pixel> hull;
  const auto add = [&](const Pixel& p, std::size_t least) {
    while (hull.size() > least && turn(hull[hull.size() - 2], hull.back(), p) <= 0.0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Pixel& p : points) add(p, 1);
  const std::size_t lower = hull.size();
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) add(*p, lower);
  hull.pop_back();
  return hull;
}

/// The part of a convex polygon on one side of a line along an axis.
std::vector<Pixel> cut_polygon(const std::vector<Pixel>& polygon, std::size_t axis, double at, double sign) {
  std::vector<Pixel> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Pixel &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a[axis] - at), db = sign * (b[axis] - at);
    if (da >= 0.0) kept.push_back(a);
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
      const double share = da / (da - db);
      kept.push_back({a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])});
    }
  }
  return kept;
}

/// The pixels that see a body, as a fan of triangles.
void add_body(const scene::CameraFrame& camera, const ConvexBody& body, int slab, int stripe,
              std::vector<SliceVertex>& vertices) {
  constexpr double kNearest = 1e-6;
  const HalfSpace ahead{{0, 0, 1}, -camera.eye[2] - kNearest};
  std::vector<Pixel> points;
  for (const ConvexBody::Face& face : (camera.is_orthographic ? body : clip_body(body, ahead)).faces)
    for (const Point& p : face.corners) {
      const double scale = 1.0 / (camera.pixel_step * (camera.is_orthographic ? 1.0 : p[2] - camera.eye[2]));
      const Pixel at{0.5 * camera.width + (p[0] - camera.eye[0]) * scale,
                     0.5 * camera.height - (p[1] - camera.eye[1]) * scale};
      for (const double x : {-kMargin, kMargin})
        for (const double y : {-kMargin, kMargin}) points.push_back({at[0] + x, at[1] + y});
    }
  std::vector<Pixel> polygon = find_hull(std::move(points));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    polygon = cut_polygon(polygon, axis, -1.0, 1.0);
    polygon = cut_polygon(polygon, axis, 1.0 + (axis == 0 ? camera.width : camera.height), -1.0);
  }
  const auto add = [&](const Pixel& p) {
    vertices.push_back({{static_cast<float>(p[0]), static_cast<float>(p[1])}, {slab, stripe}});
  };
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    add(polygon[0]);
    add(polygon[i]);
    add(polygon[i + 1]);
  }
}

/// Least and most of t over the box.
std::pair<double, double> range_of(const ConvexBody& box, const SlabFamily& family, const Point& eye) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const ConvexBody::Face& face : box.faces)
    for (const Point& p : face.corners) {
      const Point d = difference(p, eye);
      const double t = family.are_shells ? std::sqrt(dot(d, d)) : family.plane.distance(p);
      least = std::min(least, t);
      most = std::max(most, t);
    }
  return {least, most};
}

/// Distance of the eye from the box; 0 inside.
double distance_from_box(const ConvexBody& box, const Point& eye) {
  double distance = 0.0;  // from the farthest of the planes that it is outside of: a lower bound
  for (const ConvexBody::Face& face : box.faces) {
    const double length = std::sqrt(dot(face.plane.normal, face.plane.normal));
    distance = std::max(distance, -face.plane.distance(eye) / length);
  }
  return distance;
}

/// Position t along axis `axis` of the grid, in local lengths across its planes; 0 where the coordinate is 0.
HalfSpace plane_of_axis(const scene::GridView& view, int axis, double& spacing) {
  const double* row = view.grid_from_camera.data() + 4 * axis;
  const double length = std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
  spacing = 1.0 / length;
  return {{row[0] / length, row[1] / length, row[2] / length}, row[3] / length};
}

double step_of(const SlicingRequest& request) {
  const SlicingSettings& settings = request.settings;
  return settings.slices > 0 ? request.diagonal / settings.slices : request.mean_spacing / settings.slices_per_voxel;
}

/// Slabs of equal thickness, at most `step`, that fill a range exactly.
void fill(double least, double most, double step, SlabFamily& family) {
  const double wanted = std::ceil((most - least) / step - 1e-9);
  if (!(wanted <= kMostSlices))
    throw Error(ErrorCode::kInvalidArgument, "this picture needs " + std::to_string(static_cast<long long>(wanted)) +
                                                 " slices, more than " + std::to_string(kMostSlices) +
                                                 ": ask for fewer by --slices");
  family.count = std::max(1, static_cast<int>(wanted));
  family.first = least;
  family.step = (most - least) / family.count;
}

/// Tangent of the angle between the view axis and the farthest corner of the picture.
double widest_slope(const scene::CameraFrame& camera) {
  return 0.5 * camera.pixel_step * std::hypot(camera.width, camera.height);
}

/// The part of the box that may be seen between slices `from` and `to`.
ConvexBody body_between(const scene::GridView& view, const ConvexBody& box, const SlabFamily& family, int from,
                        int to) {
  const double near = family.first + from * family.step, far = family.first + to * family.step;
  if (!family.are_shells) {
    const ConvexBody above = clip_body(box, from_on(family.plane, near));
    return clip_body(above, reversed(from_on(family.plane, far)));
  }
  // Seen at the greatest angle, a shell lies nearer to the eye's plane.
  const double slope = widest_slope(view.camera), eye = view.camera.eye[2];
  const HalfSpace ahead{{0, 0, 1}, -eye};
  const ConvexBody above = clip_body(box, from_on(ahead, std::max(near, 0.0) / std::sqrt(1.0 + slope * slope)));
  return clip_body(above, reversed(from_on(ahead, far)));
}

/// Slabs in an order in which every ray passes them, whichever way it goes: from the eye up, then from the eye down.
std::vector<int> order_slabs(const scene::GridView& view, const SlabFamily& family, bool is_in_order_of_t) {
  std::vector<int> order(static_cast<std::size_t>(family.count));
  std::iota(order.begin(), order.end(), 0);
  if (is_in_order_of_t || family.are_shells) return order;
  double eye = std::floor((family.plane.distance(view.camera.eye) - family.first) / family.step);
  if (view.camera.is_orthographic) eye = family.plane.normal[2] < 0.0 ? family.count : -1.0;
  const auto below = order.begin() + static_cast<std::ptrdiff_t>(std::clamp<double>(eye, 0.0, family.count));
  std::reverse(order.begin(), below);
  std::rotate(order.begin(), below, order.end());
  return order;
}

/// Layers between the textures of a stack, front to back.
std::vector<int> order_layers(const scene::GridView& view, const SlicingRequest& request, int axis) {
  SlabFamily layers;
  double spacing = 1.0;
  layers.plane = plane_of_axis(view, axis, spacing);
  layers.first = request.lower[axis] * spacing;
  layers.step = spacing;
  layers.count = static_cast<int>(std::lround(request.upper[axis] - request.lower[axis]));
  return order_slabs(view, layers, false);
}

void add_stripes(const scene::GridView& view, const SlicingRequest& request, const SlabFamily& family,
                 const ConvexBody& body, int slab, std::span<const int> layers, std::vector<SliceVertex>& vertices) {
  const int axis = family.stripe_axis;
  double spacing = 1.0;
  const HalfSpace plane = plane_of_axis(view, axis, spacing);
  const auto [least, most] = range_of(body, {.plane = plane}, {});
  for (const int layer : layers) {
    const double near = (request.lower[axis] + layer) * spacing, far = (request.lower[axis] + layer + 1) * spacing;
    if (far < least || near > most) continue;
    const ConvexBody above = clip_body(body, from_on(plane, near));
    add_body(view.camera, clip_body(above, reversed(from_on(plane, far))), slab, layer, vertices);
  }
}

}  // namespace

ConvexBody make_box(const scene::GridView& view, const Point& lower, const Point& upper) {
  const auto corner = [&](int number) {
    Point p{};
    for (int axis = 0; axis < 3; ++axis) p[axis] = number >> axis & 1 ? upper[axis] : lower[axis];
    return scene::transform_point(view.camera_from_grid, p);
  };
  ConvexBody box;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
      double spacing = 1.0;
      HalfSpace plane = plane_of_axis(view, axis, spacing);
      plane.offset -= (side ? upper[axis] : lower[axis]) * spacing;
      if (side) plane = reversed(plane);
      box.faces.push_back({plane, {corner(base), corner(base + u), corner(base + u + v), corner(base + v)}});
    }
  return box;
}

ConvexBody clip_body(const ConvexBody& body, const HalfSpace& half_space) {
  ConvexBody clipped;
  std::vector<Point> cut;
  bool is_cut = false;  // otherwise a face that lies in the plane would be there twice
  for (const ConvexBody::Face& face : body.faces) {
    std::vector<Point> kept;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Point &a = face.corners[i], &b = face.corners[(i + 1) % face.corners.size()];
      const double da = half_space.distance(a), db = half_space.distance(b);
      if (da >= 0.0) kept.push_back(a);
      is_cut = is_cut || da < 0.0;
      if (da == 0.0) cut.push_back(a);
      if (da > 0.0 && db < 0.0) cut.push_back(leave(a, da, b, db));
      if (da < 0.0 && db > 0.0) cut.push_back(leave(b, db, a, da));
      if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) kept.push_back(cut.back());
    }
    if (kept.size() >= 3) clipped.faces.push_back({face.plane, std::move(kept)});
  }
  std::vector<Point> cap = put_in_order(std::move(cut), half_space.normal);
  if (is_cut && !cap.empty() && !clipped.faces.empty()) clipped.faces.push_back({half_space, std::move(cap)});
  return clipped;
}

int axis_along(const scene::GridView& view) {
  // How much the view turns from the axis in the grid's own proportions: by the angle to the normal of its planes.
  int best = 0;
  double most = -1.0;
  for (int axis = 0; axis < 3; ++axis) {
    double spacing = 1.0;
    const double along = std::abs(plane_of_axis(view, axis, spacing).normal[2]);
    if (along > most) best = axis;
    most = std::max(most, along);
  }
  return best;
}

SlabFamily make_slabs_across(const scene::GridView& view, const SlicingRequest& request, const Point& direction) {
  SlabFamily family;
  family.plane.normal = direction;
  const auto [least, most] = range_of(make_box(view, request.lower, request.upper), family, view.camera.eye);
  fill(least, most, step_of(request), family);
  return family;
}

SlabFamily make_slabs(const scene::GridView& view, const SlicingRequest& request) {
  const SlicingKind kind = request.settings.kind;
  const ConvexBody box = make_box(view, request.lower, request.upper);
  SlabFamily family;
  if (kind == SlicingKind::kObject2d || kind == SlicingKind::kObject2dInterpolated) {
    const int axis = axis_along(view);
    double spacing = 1.0;
    family.plane = plane_of_axis(view, axis, spacing);
    const double least = request.lower[axis] * spacing, most = request.upper[axis] * spacing;
    if (kind == SlicingKind::kObject2dInterpolated) {
      fill(least, most, step_of(request), family);
      return family;
    }
    family.step = spacing;
    family.first = least - (request.is_centred ? 0.5 * spacing : 0.0);
    family.count = static_cast<int>(std::lround((most - least) / spacing)) + (request.is_centred ? 1 : 0);
    return family;
  }
  family.are_shells = kind == SlicingKind::kShells && !view.camera.is_orthographic;
  family.plane = {{0, 0, 1}, 0.0};
  if (kind == SlicingKind::kStripes2d) family.stripe_axis = axis_along(view);
  auto [least, most] = range_of(box, family, view.camera.eye);
  // Nothing is seen behind the eye, or the plane of an orthographic camera.
  least = family.are_shells ? distance_from_box(box, view.camera.eye) : std::max(least, view.camera.eye[2]);
  if (most > least) fill(least, most, step_of(request), family);
  return family;
}

double longest_slab(const scene::GridView& view, const SlicingRequest& request, const SlabFamily& family) {
  if (family.are_shells) return family.step;  // rays from their middle
  const scene::CameraFrame& camera = view.camera;
  const Point& normal = family.plane.normal;
  double least = std::abs(normal[2]);
  if (!camera.is_orthographic) {
    // Of rays (x, y, 1): linear over the picture, with extremes in its corners.
    const double across = 0.5 * camera.pixel_step * camera.width * std::abs(normal[0]) +
                          0.5 * camera.pixel_step * camera.height * std::abs(normal[1]);
    const double slope = widest_slope(camera);
    least = std::max(std::abs(normal[2]) - across, 0.0) / std::sqrt(1.0 + slope * slope);
  }
  return least * request.diagonal > family.step ? family.step / least : request.diagonal;
}

SliceTriangles make_triangles(const scene::GridView& view, const SlicingRequest& request, const SlabFamily& family,
                              bool is_in_order_of_t) {
  SliceTriangles triangles;
  const ConvexBody box = make_box(view, request.lower, request.upper);
  std::vector<int> layers;
  if (family.stripe_axis >= 0) layers = order_layers(view, request, family.stripe_axis);
  for (const int slab : order_slabs(view, family, is_in_order_of_t)) {
    const ConvexBody body = body_between(view, box, family, slab, slab + 1);
    const std::size_t first = triangles.vertices.size();
    if (family.stripe_axis >= 0)
      add_stripes(view, request, family, body, slab, layers, triangles.vertices);
    else
      add_body(view.camera, body, slab, 0, triangles.vertices);
    triangles.slabs.push_back({slab, first, triangles.vertices.size() - first});
  }
  return triangles;
}

SliceTriangles make_slice_triangles(const scene::GridView& view, const SlicingRequest& request,
                                    const SlabFamily& family) {
  SliceTriangles triangles;
  const ConvexBody box = make_box(view, request.lower, request.upper);
  for (int slice = 0; slice <= family.count; ++slice) {
    const std::size_t first = triangles.vertices.size();
    add_body(view.camera, body_between(view, box, family, slice - 1, slice + 1), slice, 0, triangles.vertices);
    triangles.slabs.push_back({slice, first, triangles.vertices.size() - first});
  }
  return triangles;
}

SliceTriangles make_box_triangles(const scene::GridView& view, const SlicingRequest& request) {
  SliceTriangles triangles;
  add_body(view.camera, make_box(view, request.lower, request.upper), 0, 0, triangles.vertices);
  triangles.slabs.push_back({0, 0, triangles.vertices.size()});
  return triangles;
}

}  // namespace tetravox::gl
