// The rays of a tile in the lanes of a vector: they set out one at a time, and come back to be written.

#if defined(TETRAVOX_CPU_WALK_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_WALK_LANES_INL
#undef TETRAVOX_CPU_WALK_LANES_INL
#else
#define TETRAVOX_CPU_WALK_LANES_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/lanes-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Gives lanes that are idle something to do.
class WalkLanes {
 protected:
  WalkLanes(const WalkJob& job, bool has_effects) : job_(job), mesh_(*job.mesh), has_effects_(has_effects) {}

  void clear(std::size_t lane) {
    lanes_.ray[lane] = kNoRay;
    lanes_.alive[lane] = 0;
    lanes_.cell[lane] = 0;
    for (int k = 0; k < 3; ++k) {
      lanes_.id[k][lane] = 0;
      lanes_.x[k][lane] = lanes_.y[k][lane] = lanes_.z[k][lane] = lanes_.scalar[k][lane] = lanes_.weight[k][lane] =
          0.0f;
    }
    lanes_.z_front[lane] = lanes_.z_checked[lane] = lanes_.scalar_front[lane] = 0.0f;
    lanes_.red[lane] = lanes_.green[lane] = lanes_.blue[lane] = lanes_.transmittance[lane] = 0.0f;
    lanes_.x_offset[lane] = lanes_.x_slope[lane] = lanes_.y_offset[lane] = lanes_.y_slope[lane] = 0.0f;
    lanes_.world_per_z[lane] = 0.0f;
    lanes_.z_near[lane] = lanes_.depth[lane] = 0.0f;
    lanes_.z_far[lane] = kEndless;
    lanes_.pixel[lane] = 0;
  }

  /// Gives every idle lane its ray's next entry, or the next ray. False when nothing is left to walk.
  bool fill() {
    bool any = false;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (!lanes_.alive[lane]) advance(lane);
      any |= lanes_.alive[lane] != 0;
    }
    return any;
  }

  void advance(std::size_t lane) {
    const TileRays& tile = *job_.tile;
    if (lanes_.ray[lane] != kNoRay) {
      if (lanes_.next_entry[lane] < tile.rays[lanes_.ray[lane]].end) return enter(lane);
      write_pixel(lane);
    }
    if (next_ray_ == tile.rays.size()) return clear(lane);
    start_ray(lane, static_cast<std::uint32_t>(next_ray_++));
    enter(lane);
  }

  void start_ray(std::size_t lane, std::uint32_t index) {
    const TileRays::Ray& ray = job_.tile->rays[index];
    const scene::RayGrid& grid = *job_.rays;
    lanes_.ray[lane] = index;
    lanes_.next_entry[lane] = ray.begin;
    lanes_.red[lane] = lanes_.green[lane] = lanes_.blue[lane] = 0.0f;
    lanes_.transmittance[lane] = 1.0f;
    const float x_slope = grid.column_slope[ray.column], y_slope = grid.row_slope[ray.row];
    lanes_.x_offset[lane] = grid.column_offset[ray.column];
    lanes_.x_slope[lane] = x_slope;
    lanes_.y_offset[lane] = grid.row_offset[ray.row];
    lanes_.y_slope[lane] = y_slope;
    lanes_.world_per_z[lane] = grid.world_per_local * std::sqrt(1.0f + x_slope * x_slope + y_slope * y_slope);
    lanes_.z_near[lane] = grid.z_near;
    lanes_.z_far[lane] = kEndless;
    lanes_.next_clip[lane] = ray.clip_begin;
    if (ray.clip_begin < ray.clip_end) next_interval(lane);
    lanes_.depth[lane] = kEndless;
    lanes_.pixel[lane] = ray.row * grid.width + ray.column;
  }

  void next_interval(std::size_t lane) const {
    const ClipInterval& interval = job_.tile->clips[lanes_.next_clip[lane]++];
    lanes_.z_near[lane] = interval.z_near;
    lanes_.z_far[lane] = interval.z_far;
  }

  /// Puts the lane in front of the cell behind its next entry.
  void enter(std::size_t lane) {
    const BoundaryFace& face = mesh_.faces[job_.tile->entries[lanes_.next_entry[lane]++].face];
    float x[3], y[3], z[3], scalar[3];
    for (int k = 0; k < 3; ++k) {
      const float* vertex = mesh_.vertices + 4 * static_cast<std::size_t>(face.vertices[k]);
      z[k] = vertex[2];
      scalar[k] = vertex[3];
      x[k] = vertex[0] - lanes_.x_slope[lane] * z[k] - lanes_.x_offset[lane];
      y[k] = vertex[1] - lanes_.y_slope[lane] * z[k] - lanes_.y_offset[lane];
      lanes_.id[k][lane] = face.vertices[k];
    }
    float total = 0.0f, depth = 0.0f, value = 0.0f;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const float weight = std::max(x[i] * y[j] - y[i] * x[j], 0.0f);
      lanes_.weight[k][lane] = weight;
      total += weight;
      depth += weight * z[k];
      value += weight * scalar[k];
      lanes_.x[k][lane] = x[k];
      lanes_.y[k][lane] = y[k];
      lanes_.z[k][lane] = z[k];
      lanes_.scalar[k][lane] = scalar[k];
    }
    lanes_.cell[lane] = face.cell;
    lanes_.z_front[lane] = total > 0.0f ? depth / total : z[0];
    lanes_.z_checked[lane] = -std::numeric_limits<float>::infinity();
    lanes_.scalar_front[lane] = total > 0.0f ? value / total : scalar[0];
    lanes_.alive[lane] = 0xFFFFFFFFu;
  }

  void write_pixel(std::size_t lane) {
    const TileRays::Ray& ray = job_.tile->rays[lanes_.ray[lane]];
    const std::size_t index = static_cast<std::size_t>(ray.row) * job_.rays->width + ray.column;
    float* pixel = job_.pixels + 4 * index;
    // Sums may round past 1 by an ulp; light may take them beyond.
    const float most = has_effects_ ? kEndless : 1.0f;
    pixel[0] = std::min(lanes_.red[lane], most);
    pixel[1] = std::min(lanes_.green[lane], most);
    pixel[2] = std::min(lanes_.blue[lane], most);
    pixel[3] = std::min(1.0f - lanes_.transmittance[lane], 1.0f);
    if (has_effects_ && job_.tables->effects->depth) job_.tables->effects->depth[index] = lanes_.depth[lane];
  }

  /// Rays that are done have no further entry.
  void forget_entries(Mask ended) const {
    HWY_ALIGN std::uint32_t lane[kLanes];
    hn::Store(hn::IfThenElseZero(uint_mask(ended), hn::Set(kUint, 1)), kUint, lane);
    for (std::size_t i = 0; i < kLanes; ++i)
      if (lane[i] && lanes_.ray[i] != kNoRay) lanes_.next_entry[i] = job_.tile->rays[lanes_.ray[i]].end;
  }

  static constexpr float kEndless = std::numeric_limits<float>::infinity();

  const WalkJob& job_;
  const FrameMesh& mesh_;
  bool has_effects_;
  mutable Lanes lanes_;
  std::size_t next_ray_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
