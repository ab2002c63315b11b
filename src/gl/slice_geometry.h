#pragma once

/// The slabs between slices of a box, and the polygons that cover them in a picture.
///
/// What a ray passes of a slab is found for each pixel by the shaders. Polygons only say which pixels may see a slab:
/// one for each, the outline of the part of the box between two slices, so that no pixel is drawn twice and none is
/// missed.

#include "src/scene/grid_view.h"
#include "tetravox/render.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::gl {

/// A place and a direction of the camera frame.
using Point = grid::Point;

/// normal . p + offset >= 0 is inside.
struct HalfSpace {
  Point normal{};
  double offset = 0.0;

  double distance(const Point& p) const { return normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2] + offset; }
};

/// A convex body by its faces: each a polygon in its plane, and the half-space on whose inner side the body lies.
struct ConvexBody {
  struct Face {
    HalfSpace plane;
    std::vector<Point> corners;
  };
  std::vector<Face> faces;

  bool is_empty() const { return faces.size() < 4; }
};

/// The box from `lower` to `upper` (grid coordinates) in the camera frame.
ConvexBody make_box(const scene::GridView& view, const Point& lower, const Point& upper);

/// The part of a body inside a half-space.
ConvexBody clip_body(const ConvexBody& body, const HalfSpace& half_space);

/// How a box is cut: slices are the places where the position t of a point is first + k * step, k whole. Of planes
/// t = plane.distance(p) with a unit normal, of shells the distance from the eye. Local lengths.
struct SlabFamily {
  HalfSpace plane;
  bool are_shells = false;
  double first = 0.0, step = 1.0;
  int count = 0;         ///< slabs 0 to count - 1 hold what is seen of the box
  int stripe_axis = -1;  ///< stripes: the axis of the stack that slabs are cut by; otherwise -1
};

/// What slices are asked for.
struct SlicingRequest {
  SlicingSettings settings;
  Point lower{}, upper{};     ///< of the box, grid coordinates
  double diagonal = 1.0;      ///< of the box, local lengths
  double mean_spacing = 1.0;  ///< of values, local lengths
  bool is_centred = false;    ///< stacks drawn texture by texture: slices lie in the middles of slabs
};

/// The axis of the grid most along the view.
int axis_along(const scene::GridView& view);

/// The slabs of a frame. @throws Error (kInvalidArgument) where they are more than `kMostSlices`.
SlabFamily make_slabs(const scene::GridView& view, const SlicingRequest& request);
/// Slabs across a direction (unit vector of the camera frame).
SlabFamily make_slabs_across(const scene::GridView& view, const SlicingRequest& request, const Point& direction);

/// The longest way of a ray through a slab, at most the diagonal of the box; local length.
double longest_slab(const scene::GridView& view, const SlicingRequest& request, const SlabFamily& family);

/// A corner of a triangle. `slab`: number of its slab; `stripe`: of the layer between two textures, or 0.
struct SliceVertex {
  std::array<float, 2> position{};  ///< pixels, rows count downwards
  std::array<std::int32_t, 2> piece{};
};

/// A slab's triangles among all vertices.
struct SlabRange {
  int slab = 0;
  std::size_t first = 0, count = 0;
};

struct SliceTriangles {
  std::vector<SliceVertex> vertices;
  std::vector<SlabRange> slabs;  ///< in the order in which rays pass them
};

/// Triangles of all slabs, front to back for every ray (or in the order of t).
SliceTriangles make_triangles(const scene::GridView& view, const SlicingRequest& request, const SlabFamily& family,
                              bool is_in_order_of_t);

/// Triangles of all slices, each with the slabs on both sides of it: those whose rays want to know its scalars.
SliceTriangles make_slice_triangles(const scene::GridView& view, const SlicingRequest& request,
                                    const SlabFamily& family);

/// The box alone: which pixels see anything.
SliceTriangles make_box_triangles(const scene::GridView& view, const SlicingRequest& request);

}  // namespace tetravox::gl
