#include "src/cpu/shadow_rays.h"

#include <algorithm>

namespace tetravox::cpu {
namespace {

Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// The local frame with its axes in another order, x, y and then `axis` as z: rows of world = frame * (p, 1).
std::array<double, 12> world_from_turned(int axis, const ShadowFrame& frame) {
  const std::array<int, 3> order{(axis + 1) % 3, (axis + 2) % 3, axis};
  std::array<double, 12> matrix{};
  for (int column = 0; column < 3; ++column) matrix[4 * order[column] + column] = frame.world_per_local;
  for (int row = 0; row < 3; ++row) matrix[4 * row + 3] = frame.origin[row];
  return matrix;
}

}  // namespace

ShadowLine make_shadow_line(const Vector3& place, const Vector3& travel, double world_per_local) {
  ShadowLine line;
  int along = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(travel[axis]) > std::abs(travel[along])) along = axis;
  line.axes = {(along + 1) % 3, (along + 2) % 3, along};
  line.sign = travel[along] < 0.0 ? -1.0 : 1.0;
  if (line.sign < 0.0) std::swap(line.axes[0], line.axes[1]);
  line.place = place;
  const double inverse = 1.0 / std::abs(travel[along]);
  for (int axis = 0; axis < 3; ++axis) line.step[axis] = travel[axis] * inverse;
  line.step[along] = line.sign;
  line.world_per_z = std::hypot(line.step[0], line.step[1], line.step[2]) * world_per_local;
  return line;
}

ShadowRays::ShadowRays(const ShadowFrame& frame, ShadowMedium& medium, const Clipping& clipping,
                       std::span<const PreparedGrid* const> clip_volumes)
    : frame_(frame), medium_(&medium), has_clipping_(!clipping.shapes.empty()) {
  if (!has_clipping_) return;
  for (int axis = 0; axis < 3; ++axis)
    clips_[axis] = make_clip_scene(clipping, clip_volumes, world_from_turned(axis, frame));
}

Vector3 ShadowRays::local_from_camera(const Vector3& seen) const {
  Vector3 local{};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) local[axis] += frame_.camera.axes[i][axis] * seen[i];
  return local;
}

void ShadowRays::attach(const std::vector<Light>& lighting, std::span<LightSource> lights,
                        const std::atomic<bool>* cancelled) {
  cancelled_ = cancelled;
  sources_.clear();
  for (const Light& light : lighting) {
    Source source{this, sources_.size(), false, {}};
    if (light.kind == LightKind::kDirectional) {
      const double length = std::hypot(light.direction[0], light.direction[1], light.direction[2]);
      for (int axis = 0; axis < 3; ++axis) source.vector[axis] = light.direction[axis] / length;
    } else if (light.kind == LightKind::kPoint) {
      source.is_near = true;
      for (int axis = 0; axis < 3; ++axis)
        source.vector[axis] = (light.position[axis] - frame_.origin[axis]) / frame_.world_per_local;
    } else {
      source.is_near = !frame_.camera.is_orthographic;
      source.vector = source.is_near ? local_from_camera(frame_.camera.eye) : frame_.camera.axes[2];
    }
    if (!source.is_near) medium_->expect_parallel(source.number, source.vector);
    sources_.push_back(source);
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].ray_context = &sources_[i];
    lights[i].trace_ray = [](const void* context, const float place[3]) noexcept {
      const auto& source = *static_cast<const Source*>(context);
      try {
        return source.rays->trace(source.number, place);
      } catch (...) {
        source.rays->note_failure(std::current_exception());
        return 1.0f;
      }
    };
  }
}

void ShadowRays::find_kept(const ShadowLine& line, double z_light, Scratch& scratch) const {
  scratch.kept.clear();
  if (!has_clipping_) {
    append_range(scratch.kept, z_light, 0.0);
    return;
  }
  // The clipping's depth is the local coordinate along the axis.
  const int along = line.axes[2], x = (along + 1) % 3, y = (along + 2) % 3;
  const double origin = line.place[along];
  const auto coordinate = [&](double z) { return origin + line.sign * z; };
  ClipRay ray;
  ray.x_slope = line.step[x] * line.sign;
  ray.y_slope = line.step[y] * line.sign;
  ray.x_offset = line.place[x] - ray.x_slope * origin;
  ray.y_offset = line.place[y] - ray.y_slope * origin;
  ray.z_begin = std::min(coordinate(z_light), origin);
  ray.z_end = std::max(coordinate(z_light), origin);
  scratch.intervals.clear();
  find_intervals(clips_[along], ray, scratch.clip[along], scratch.intervals);
  if (line.sign < 0.0) std::reverse(scratch.intervals.begin(), scratch.intervals.end());
  for (const ClipInterval& interval : scratch.intervals) {
    const double a = (interval.z_near - origin) * line.sign, b = (interval.z_far - origin) * line.sign;
    append_range(scratch.kept, std::max(z_light, std::min(a, b)), std::min(0.0, std::max(a, b)));
  }
}

void ShadowRays::note_failure(const std::exception_ptr& failure) const {
  const std::lock_guard lock(failure_mutex_);
  if (!failure_) failure_ = failure;
}

void ShadowRays::rethrow_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

float ShadowRays::trace(std::size_t light, const float place[3]) const {
  if (cancelled_ && cancelled_->load(std::memory_order_relaxed)) return 1.0f;
  const Source& source = sources_[light];
  const Vector3 at = local_from_camera({place[0], place[1], place[2]});
  Vector3 travel = source.vector;
  double distance = std::numeric_limits<double>::infinity();
  if (source.is_near) {
    travel = difference(at, source.vector);
    distance = std::hypot(travel[0], travel[1], travel[2]);
    if (!(distance > 0.0)) return 1.0f;
    for (double& coordinate : travel) coordinate /= distance;
  }
  ShadowLine line = make_shadow_line(at, travel, frame_.world_per_local);
  line.light = light;
  Scratch& scratch = scratches_.local();
  find_kept(line, -distance * std::abs(travel[line.axes[2]]), scratch);
  Transmission sum;
  if (!scratch.kept.empty()) medium_->gather(line, scratch.kept, sum);
  return static_cast<float>(sum.value());
}

}  // namespace tetravox::cpu
