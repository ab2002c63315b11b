#include "src/cpu/tile_intervals.h"

#include <algorithm>

namespace tetravox::cpu {

void TileIntervals::find(const ClipScene& clip, const scene::RayGrid& grid, int column, int row, MarchRays& rays) {
  intervals_.clear();
  next_.assign(MarchRays::kCount, 0);
  end_.assign(MarchRays::kCount, 0);
  for (int y = 0; y < std::min(kTileSize, grid.height - row); ++y)
    for (int x = 0; x < std::min(kTileSize, grid.width - column); ++x) {
      const auto ray = static_cast<std::size_t>(y * kTileSize + x);
      next_[ray] = intervals_.size();
      find_intervals(clip,
                     {grid.column_offset[column + x], grid.column_slope[column + x], grid.row_offset[row + y],
                      grid.row_slope[row + y], grid.z_near, std::numeric_limits<double>::infinity()},
                     scratch_, intervals_);
      end_[ray] = intervals_.size();
      rays.has_intervals |= end_[ray] > next_[ray] + 1;
      if (!advance(ray, rays)) rays.z_far[ray] = kNothing;
    }
}

void TileIntervals::note_drawn(MarchRays& rays, int count) {
  for (int i = 0; i < count; ++i) rays.z_near[rays.met.ray[i]] = rays.met.z_leave[i];
}

bool TileIntervals::advance_ended(MarchRays& rays) {
  bool is_any_moved = false;
  for (int i = 0; i < rays.ended_count; ++i) {
    const auto ray = static_cast<std::size_t>(rays.ended[i]);
    is_any_moved |= rays.z_far[ray] >= rays.z_near[ray] && advance(ray, rays);
  }
  return is_any_moved;
}

bool TileIntervals::advance_all(MarchRays& rays) {
  bool is_any_left = false;
  for (std::size_t ray = 0; ray < next_.size(); ++ray) {
    const bool is_left = rays.z_far[ray] >= rays.z_near[ray] && advance(ray, rays);
    if (!is_left) rays.z_far[ray] = kNothing;
    is_any_left |= is_left;
  }
  return is_any_left;
}

bool TileIntervals::advance(std::size_t ray, MarchRays& rays) {
  if (next_[ray] == end_[ray]) return false;
  const ClipInterval& interval = intervals_[next_[ray]++];
  rays.z_near[ray] = interval.z_near;
  rays.z_far[ray] = interval.z_far;
  return true;
}

}  // namespace tetravox::cpu
