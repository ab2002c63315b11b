#include "src/scene/grid_view.h"

#include <algorithm>

namespace tetravox::scene {
namespace {

/// a * b for 3 x 4 matrices of affine maps.
std::array<double, 12> chain(const std::array<double, 12>& a, const std::array<double, 12>& b) {
  std::array<double, 12> c{};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      double sum = column == 3 ? a[4 * row + 3] : 0.0;
      for (int i = 0; i < 3; ++i) sum += a[4 * row + i] * b[4 * i + column];
      c[4 * row + column] = sum;
    }
  return c;
}

}  // namespace

grid::Point transform_point(const std::array<double, 12>& m, const grid::Point& p) {
  grid::Point q{};
  for (int row = 0; row < 3; ++row)
    q[row] = m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
  return q;
}

LocalFrame find_local_frame(const PreparedGrid& grid) {
  LocalFrame frame;
  double half_extent = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    frame.origin[axis] = 0.5 * grid.bounds[axis].min + 0.5 * grid.bounds[axis].max;
    half_extent = std::max(half_extent, 0.5 * grid.bounds[axis].max - 0.5 * grid.bounds[axis].min);
  }
  if (half_extent > 0.0) frame.world_per_local = half_extent;
  return frame;
}

GridView make_grid_view(const PreparedGrid& grid, const grid::GridFrame& frame, const Camera& camera, int width,
                        int height) {
  GridView view;
  const auto [center, world_per_local] = find_local_frame(grid);
  view.world_per_local = world_per_local;
  view.origin = center;
  view.camera = make_camera_frame(center, view.world_per_local, camera, width, height);
  // Offsets are taken from the centre, so that a grid far from the origin loses nothing.
  std::array<double, 12> grid_from_offset{}, offset_from_camera{}, offset_from_grid{}, camera_from_offset{};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      grid_from_offset[4 * row + column] = frame.grid_from_world[3 * row + column];
      grid_from_offset[4 * row + 3] +=
          frame.grid_from_world[3 * row + column] * (center[column] - frame.origin[column]);
      offset_from_camera[4 * row + column] = view.camera.axes[column][row] * view.world_per_local;
      offset_from_grid[4 * row + column] = frame.world_from_grid[3 * row + column];
      camera_from_offset[4 * row + column] = view.camera.axes[row][column] / view.world_per_local;
    }
  for (int row = 0; row < 3; ++row) offset_from_grid[4 * row + 3] = frame.origin[row] - center[row];
  view.grid_from_camera = chain(grid_from_offset, offset_from_camera);
  view.camera_from_grid = chain(camera_from_offset, offset_from_grid);
  view.eye = transform_point(view.grid_from_camera, view.camera.eye);
  if (view.camera.is_orthographic)
    for (int row = 0; row < 3; ++row) view.eye[row] = view.grid_from_camera[4 * row + 2];
  return view;
}

std::array<std::int64_t, 3> nearest_brick(const PreparedGrid& grid, const grid::GridFrame& frame,
                                          const GridView& view) {
  std::array<std::int64_t, 3> nearest{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t last = grid.bricks.counts[axis] - 1;
    if (view.camera.is_orthographic)
      nearest[axis] = view.eye[axis] > 0.0 ? 0 : last;
    else
      while (nearest[axis] < last && frame.plane(axis, (nearest[axis] + 1) * kBrickCells) <= view.eye[axis])
        ++nearest[axis];
  }
  return nearest;
}

}  // namespace tetravox::scene
