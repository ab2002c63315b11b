#pragma once

/// The camera's frame of a grid.

#include "src/grid/frame.h"
#include "src/scene/camera_frame.h"
#include "tetravox/grid.h"

#include <array>
#include <cstdint>

namespace tetravox::scene {

/// Local lengths of a grid: world = origin + local * world_per_local, so that |local| <= 1.
struct LocalFrame {
  Vector3 origin{};  ///< the middle of the bounds
  double world_per_local = 1.0;
};
LocalFrame find_local_frame(const PreparedGrid& grid);

/// The camera's frame of a grid, and the way from it to grid coordinates.
struct GridView {
  CameraFrame camera;
  std::array<double, 12> grid_from_camera{};  ///< rows of a 3 x 4 matrix
  std::array<double, 12> camera_from_grid{};
  grid::Point eye{};  ///< grid coordinates; of an orthographic camera: the direction it looks in
  Vector3 origin{};   ///< world position of the local origin
  double world_per_local = 1.0;
};

GridView make_grid_view(const PreparedGrid& grid, const grid::GridFrame& frame, const Camera& camera, int width,
                        int height);

/// The brick that holds the eye, or the one nearest to it. Along any ray from the eye the number of bricks between a
/// brick and this one, counted along the axes and summed, ascends.
std::array<std::int64_t, 3> nearest_brick(const PreparedGrid& grid, const grid::GridFrame& frame, const GridView& view);

/// A point under a 3 x 4 matrix.
grid::Point transform_point(const std::array<double, 12>& matrix, const grid::Point& point);

}  // namespace tetravox::scene
