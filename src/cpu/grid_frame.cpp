#include "src/cpu/grid_frame.h"

#include "src/grid/summaries.h"
#include "src/scene/brick_groups.h"
#include "src/support/threads.h"

#include <algorithm>
#include <cmath>

namespace tetravox::cpu {
namespace {

/// Where points in front of the eye are seen, in pixels from the middle of the picture.
class SeenBounds {
 public:
  explicit SeenBounds(const scene::CameraFrame& camera) : camera_(camera) {}

  void add(const grid::Point& seen) {
    double scale = 1.0 / camera_.pixel_step;
    if (!camera_.is_orthographic) scale /= seen[2] - camera_.eye[2];
    for (int i = 0; i < 2; ++i) {
      const double offset = (seen[i] - camera_.eye[i]) * scale;
      low_[i] = std::min(low_[i], offset);
      high_[i] = std::max(high_[i], offset);
    }
  }

  /// None where nothing was added. A pixel more on either side stands for rounding.
  TileBounds pixels() const {
    if (!(low_[0] <= high_[0])) return {};
    const auto pixel = [](double at, int size) {
      return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(size)));
    };
    return {pixel(std::floor(low_[0] + 0.5 * camera_.width - 1.5), camera_.width),
            pixel(std::ceil(high_[0] + 0.5 * camera_.width + 1.5), camera_.width),
            pixel(std::floor(0.5 * camera_.height - high_[1] - 1.5), camera_.height),
            pixel(std::ceil(0.5 * camera_.height - low_[1] + 1.5), camera_.height)};
  }

 private:
  const scene::CameraFrame& camera_;
  double low_[2] = {HUGE_VAL, HUGE_VAL}, high_[2] = {-HUGE_VAL, -HUGE_VAL};
};

/// Pixels whose rays may meet the box: of its part in front of the eye.
TileBounds project_box(const grid::BrickBox& box, const grid::GridFrame& frame, const scene::GridView& view) {
  constexpr double kNearest = 1e-6;  // in front of the eye
  const scene::CameraFrame& camera = view.camera;
  std::array<grid::Point, 8> corners;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    grid::Point at{};
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = frame.plane(axis, box.first[axis] + (corner >> axis & 1 ? box.count[axis] : 0));
    corners[corner] = scene::transform_point(view.camera_from_grid, at);
  }
  SeenBounds bounds(camera);
  const auto depth_of = [&](const grid::Point& seen) { return seen[2] - camera.eye[2]; };
  const auto is_in_front = [&](const grid::Point& seen) { return camera.is_orthographic || depth_of(seen) > kNearest; };
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const grid::Point& from = corners[corner];
    if (is_in_front(from)) bounds.add(from);
    // Edges that pass the eye are cut.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const grid::Point& to = corners[corner ^ (std::size_t{1} << axis)];
      if (!is_in_front(from) || is_in_front(to)) continue;
      const double t = (kNearest - depth_of(from)) / (depth_of(to) - depth_of(from));
      grid::Point cut{};
      for (int i = 0; i < 3; ++i) cut[i] = from[i] + t * (to[i] - from[i]);
      cut[2] = camera.eye[2] + kNearest;
      bounds.add(cut);
    }
  }
  return bounds.pixels();
}

/// Bricks front to back: by the distance of their group from the eye's, then by their own from the group's nearest.
class ViewOrder {
 public:
  ViewOrder(const PreparedGrid& grid, const std::array<std::int64_t, 3>& nearest) : grid_(grid), nearest_(nearest) {}

  std::size_t place_of(std::uint32_t drawn) const {
    const std::array<std::uint32_t, 3> at = scene::position_of(grid_, drawn);
    const bool is_group = scene::is_group(grid_, drawn);
    std::int64_t groups = 0, bricks = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t group = is_group ? at[axis] : at[axis] / kBricks;
      groups += std::abs(group - nearest_[axis] / kBricks);
      if (is_group) continue;
      const std::int64_t entered = std::clamp(nearest_[axis], group * kBricks, group * kBricks + kBricks - 1);
      bricks += std::abs(at[axis] - entered);
    }
    return static_cast<std::size_t>(groups * kPlaces + bricks);
  }
  std::size_t place_count() const {
    std::size_t groups = 1;
    for (const std::uint32_t count : grid_.bricks.counts) groups += (count + kBricks - 1) / kBricks;
    return groups * kPlaces;
  }

 private:
  static constexpr std::int64_t kBricks = scene::kGroupBricks;
  static constexpr std::int64_t kPlaces = 3 * (kBricks - 1) + 1;  // in a group

  const PreparedGrid& grid_;
  std::array<std::int64_t, 3> nearest_;
};

/// A counting sort.
std::vector<std::uint32_t> order_bricks(const PreparedGrid& grid, const grid::GridFrame& frame,
                                        const std::vector<std::uint32_t>& bricks, const scene::GridView& view) {
  const ViewOrder order(grid, scene::nearest_brick(grid, frame, view));
  std::vector<std::uint32_t> starts(order.place_count() + 1);
  for (const std::uint32_t brick : bricks) ++starts[order.place_of(brick) + 1];
  for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
  std::vector<std::uint32_t> ordered(bricks.size());
  for (const std::uint32_t brick : bricks) ordered[starts[order.place_of(brick)]++] = brick;
  return ordered;
}

/// Calls `visit(tile, bounds in the tile)` for the tiles that a box of pixels touches.
template <class Visit>
void for_each_tile(const TileBounds& pixels, int tile_columns, const Visit& visit) {
  if (pixels.column_begin >= pixels.column_end || pixels.row_begin >= pixels.row_end) return;
  for (int row = pixels.row_begin / kTileSize; row <= (pixels.row_end - 1) / kTileSize; ++row)
    for (int column = pixels.column_begin / kTileSize; column <= (pixels.column_end - 1) / kTileSize; ++column) {
      const auto inside = [](int at, int tile) { return std::clamp(at - tile * kTileSize, 0, kTileSize); };
      visit(static_cast<std::size_t>(row) * tile_columns + column,
            TileBounds{inside(pixels.column_begin, column), inside(pixels.column_end, column),
                       inside(pixels.row_begin, row), inside(pixels.row_end, row)});
    }
}

}  // namespace

BrickBins bin_bricks(const PreparedGrid& grid, const grid::GridFrame& frame, const std::vector<std::uint32_t>& bricks,
                     const scene::GridView& view) {
  BrickBins bins;
  bins.columns = (view.camera.width + kTileSize - 1) / kTileSize;
  bins.rows = (view.camera.height + kTileSize - 1) / kTileSize;
  bins.starts.assign(bins.tile_count() + 1, 0);
  const std::vector<std::uint32_t> ordered = order_bricks(grid, frame, bricks, view);
  std::vector<TileBounds> pixels(ordered.size());
  support::parallel_chunks(ordered.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      pixels[i] = project_box(scene::box_of_drawn(grid, ordered[i]), frame, view);
  });
  for (const TileBounds& seen : pixels)
    for_each_tile(seen, bins.columns, [&](std::size_t tile, const TileBounds&) { ++bins.starts[tile + 1]; });
  for (std::size_t i = 1; i < bins.starts.size(); ++i) bins.starts[i] += bins.starts[i - 1];
  bins.bricks.resize(bins.starts.back());
  std::vector<std::size_t> next(bins.starts.begin(), bins.starts.end() - 1);
  for (std::size_t i = 0; i < ordered.size(); ++i)
    for_each_tile(pixels[i], bins.columns, [&](std::size_t tile, const TileBounds& bounds) {
      bins.bricks[next[tile]++] = {ordered[i], bounds};
    });
  return bins;
}

}  // namespace tetravox::cpu
