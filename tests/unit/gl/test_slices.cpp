/// Slabs of a box: together they are the box, in an order in which every ray passes them.

#include "src/gl/slice_block.h"
#include "src/gl/slice_geometry.h"
#include "tests/common/cameras.h"
#include "tests/common/grid_builder.h"
#include "tetravox/error.h"
#include "tetravox/slicing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace tetravox::gl {
namespace {

Point difference(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double triple_product(const Point& a, const Point& b, const Point& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// By cones from a point inside to the faces.
double volume_of(const ConvexBody& body) {
  if (body.is_empty()) return 0.0;
  Point inside{};
  int count = 0;
  for (const ConvexBody::Face& face : body.faces)
    for (const Point& p : face.corners) {
      for (int i = 0; i < 3; ++i) inside[i] += p[i];
      ++count;
    }
  for (double& component : inside) component /= count;
  double volume = 0.0;
  for (const ConvexBody::Face& face : body.faces)
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i)
      volume += std::abs(triple_product(difference(face.corners[0], inside), difference(face.corners[i], inside),
                                        difference(face.corners[i + 1], inside))) /
                6.0;
  return volume;
}

/// A sheared grid seen by a camera.
struct View {
  PreparedGrid grid;
  grid::GridFrame frame;
  scene::GridView view;
  RenderSettings settings;

  explicit View(const char* camera_name) {
    tests::GridOptions options;
    options.dimensions = {9, 8, 7};
    options.direction = {0.9, 0.3, 0.0, -0.2, 0.8, 0.3, 0.1, 0.0, -1.1};
    grid = prepare_grid(make_grid(options, [](const Vector3& p) { return p[0]; }));
    frame = grid::make_grid_frame(grid.data.shape);
    for (const auto& [name, camera] : tests::make_cameras(grid.bounds))
      if (name == camera_name) view = scene::make_grid_view(grid, frame, camera, 60, 40);
    settings.width = 60;
    settings.height = 40;
    settings.source = Source::kSlices;
  }
  SlicingRequest request(SlicingKind kind, int slices) {
    settings.slicing.kind = kind;
    settings.slicing.slices = slices;
    return request_of(grid, frame, view, settings);
  }
};

constexpr SlicingKind kPlanes[] = {SlicingKind::kObject2d, SlicingKind::kObject2dInterpolated, SlicingKind::kStripes2d,
                                   SlicingKind::kView3d};

constexpr SlicingKind kAllKinds[] = {SlicingKind::kObject2d, SlicingKind::kObject2dInterpolated,
                                     SlicingKind::kStripes2d, SlicingKind::kView3d, SlicingKind::kShells};

TEST(SliceGeometry, ClippedPartsAddUpToTheBody) {
  View seen("outside");
  const SlicingRequest request = seen.request(SlicingKind::kView3d, 10);
  const ConvexBody box = make_box(seen.view, request.lower, request.upper);
  const double whole = volume_of(box);
  EXPECT_GT(whole, 0.1);
  const HalfSpace cuts[] = {{{0.3, 0.5, 0.2}, 0.1}, {{0, 0, 1}, -0.2}, {{-1, 0.2, 0}, 0.0}};
  for (const HalfSpace& cut : cuts) {
    const HalfSpace other{{-cut.normal[0], -cut.normal[1], -cut.normal[2]}, -cut.offset};
    EXPECT_NEAR(volume_of(clip_body(box, cut)) + volume_of(clip_body(box, other)), whole, 1e-12 * whole);
  }
  EXPECT_TRUE(clip_body(box, {{0, 0, 1}, -100.0}).is_empty());
  EXPECT_EQ(clip_body(box, {{0, 0, 1}, 100.0}).faces.size(), 6u);
}

TEST(SliceGeometry, APlaneThroughAFaceLeavesItThereOnce) {
  View seen("orthographic");
  const SlicingRequest request = seen.request(SlicingKind::kObject2d, 0);
  const ConvexBody box = make_box(seen.view, request.lower, request.upper);
  for (const ConvexBody::Face& face : box.faces) EXPECT_EQ(clip_body(box, face.plane).faces.size(), 6u);
}

TEST(SliceGeometry, SlabsFillTheBox) {
  for (const char* camera : {"outside", "orthographic"})
    for (const SlicingKind kind : kPlanes) {
      View seen(camera);
      const SlicingRequest request = seen.request(kind, 23);
      const SlabFamily family = make_slabs(seen.view, request);
      const ConvexBody box = make_box(seen.view, request.lower, request.upper);
      double sum = 0.0;
      for (int slab = 0; slab < family.count; ++slab) {
        HalfSpace near = family.plane, far = family.plane;
        near.offset -= family.first + slab * family.step;
        far.offset -= family.first + (slab + 1) * family.step;
        far = {{-far.normal[0], -far.normal[1], -far.normal[2]}, -far.offset};
        sum += volume_of(clip_body(clip_body(box, near), far));
      }
      EXPECT_NEAR(sum, volume_of(box), 1e-9 * sum) << camera << " " << name_of(kind);
      if (kind != SlicingKind::kObject2d) {
        EXPECT_LE(family.step, request.diagonal / 23 * (1 + 1e-9));
      }
    }
}

/// From the eye's slab up, then down: for a ray either way slabs come front to back. Rays of an orthographic camera all
/// go the same way through planes; shells lie one round the other.
TEST(SliceGeometry, EveryRayPassesSlabsInTheirOrder) {
  for (const char* camera : {"outside", "orthographic", "inside", "near", "plane"})
    for (const SlicingKind kind : kAllKinds) {
      View seen(camera);
      const SlicingRequest request = seen.request(kind, 40);
      const SlabFamily family = make_slabs(seen.view, request);
      const SliceTriangles triangles = make_triangles(seen.view, request, family, false);
      ASSERT_EQ(static_cast<int>(triangles.slabs.size()), family.count);
      std::set<int> all;
      int last_up = -1, last_down = family.count;
      double eye = (family.plane.distance(seen.view.camera.eye) - family.first) / family.step;
      if (family.are_shells) eye = 0.0;
      if (seen.view.camera.is_orthographic) eye = family.plane.normal[2] > 0.0 ? 0.0 : family.count;
      if (seen.view.camera.is_orthographic) {
        ASSERT_GT(std::abs(family.plane.normal[2]), 0.0);
      }
      for (const SlabRange& slab : triangles.slabs) {
        all.insert(slab.slab);
        if (slab.slab + 0.5 > eye) {
          EXPECT_GT(slab.slab, last_up);
          last_up = slab.slab;
        } else {
          EXPECT_LT(slab.slab, last_down);
          last_down = slab.slab;
        }
      }
      EXPECT_EQ(all.size(), triangles.slabs.size());
    }
}

TEST(SliceGeometry, TooManySlicesAreRefused) {
  View seen("outside");
  SlicingRequest request = seen.request(SlicingKind::kView3d, 0);
  request.settings.slices_per_voxel = 64.0;
  request.mean_spacing = 1e-6;
  EXPECT_THROW(make_slabs(seen.view, request), Error);
}

TEST(SliceSurfaces, ColoursAreThoseOfAllThatAreMet) {
  const Isosurface low{1.0, {1, 0, 0}, {0, 1, 0}, 0.5, true}, high{2.0, {0, 0, 1}, {1, 1, 1}, 0.25, false};
  const auto colors = make_surface_colors({high, low});
  ASSERT_EQ(colors.size(), 9u);
  const auto seen = [&](int front, int back) { return colors[static_cast<std::size_t>(3 * back + front)]; };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(seen(i, i)[3], 0.0f);
  EXPECT_EQ(seen(0, 1), (std::array<float, 4>{0.5f, 0, 0, 0.5f}));  // its front
  EXPECT_EQ(seen(1, 0), (std::array<float, 4>{0, 0.5f, 0, 0.5f}));  // its back
  EXPECT_EQ(seen(1, 2), (std::array<float, 4>{0, 0, 0.25f, 0.25f}));
  EXPECT_EQ(seen(2, 1), (std::array<float, 4>{0, 0, 0, 0}));               // one-sided
  EXPECT_EQ(seen(0, 2), (std::array<float, 4>{0.5f, 0, 0.125f, 0.625f}));  // both, the nearer one first
  EXPECT_EQ(seen(2, 0), (std::array<float, 4>{0, 0.5f, 0, 0.5f}));
}

TEST(HalfAngle, SlicesLieBetweenViewAndLight) {
  for (const Point& light :
       {Point{1, 0, 0}, Point{0, 0.6, 0.8}, Point{0, 0.6, -0.8}, Point{0, 0, 1}, Point{0, 0, -1}}) {
    const Point half = half_way(light);
    EXPECT_NEAR(std::hypot(half[0], half[1], half[2]), 1.0, 1e-12);
    const double to_light = half[0] * light[0] + half[1] * light[1] + half[2] * light[2];
    EXPECT_GT(to_light, 0.7);
    EXPECT_NEAR(to_light, std::abs(half[2]), 1e-12);
  }
}

}  // namespace
}  // namespace tetravox::gl
