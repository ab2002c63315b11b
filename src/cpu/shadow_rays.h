#pragma once

/// Exact shadows: a ray from the light to each place that is lit gathers the optical depth on its way.
///
/// `ShadowRays` knows lights and clipping; a `ShadowMedium` (a mesh or a grid) knows what lies along a line.

#include "src/cpu/clip_intervals.h"
#include "src/cpu/kernels/effects.h"
#include "src/optics/extinction_integral.h"
#include "src/scene/camera_frame.h"
#include "tetravox/lighting.h"

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <mutex>
#include <span>
#include <vector>

namespace tetravox::cpu {

/// A line from a light to a place, with a frame of its own: z runs along the local axis that the line follows most,
/// grows on the way and is 0 at the place; x and y are sheared so that the line is x = y = 0 (Woop, Benthin, Wald
/// 2013).
struct ShadowLine {
  std::array<int, 3> axes{};  ///< local axes of x, y, z; (x, y, z) is right-handed
  double sign = 1.0;          ///< of z
  Vector3 place{};            ///< local
  Vector3 step{};             ///< local change for one unit of z
  double world_per_z = 1.0;
  std::size_t light = kNoLight;  ///< the one that a medium may be prepared for

  static constexpr std::size_t kNoLight = static_cast<std::size_t>(-1);
};

/// `travel`: local unit vector from the light to the place.
ShadowLine make_shadow_line(const Vector3& place, const Vector3& travel, double world_per_local);

/// What comes through to a place.
struct Transmission {
  double optical_depth = 0.0;
  double through_surfaces = 1.0;

  double value() const { return through_surfaces * std::exp(-optical_depth); }
};

/// What absorbs along lines: extinction, surfaces and weights, as the kernels have them.
struct ShadowOptics {
  const optics::ExtinctionIntegral* extinction = nullptr;
  std::span<const SurfaceSheet> surfaces;
  float weight_by_change = 0.0f, weight_by_gradient = 0.0f;     ///< see Effects
  double dark_depth = std::numeric_limits<double>::infinity();  ///< beyond it nothing matters

  bool is_dark(const Transmission& sum) const { return sum.optical_depth > dark_depth || sum.through_surfaces <= 0.0; }
};

/// A part of a line along which the scalar is linear.
struct ShadowPiece {
  optics::ExtinctionIntegral::Mark front, back;
  double length = 0.0;  ///< world
  /// Magnitude in its middle, stored scalars a local length; for `weight_by_gradient` alone. (The picture takes the
  /// mean of three along its longer pieces.)
  double gradient = 0.0;
};

/// Adds what a piece absorbs, surfaces left out.
inline void add_extinction(const ShadowOptics& optics, const ShadowPiece& piece, Transmission& sum) {
  double weight = 1.0;
  if (optics.weight_by_change > 0.0f)
    weight = std::min(1.0, optics.weight_by_change * std::abs(piece.back.scalar - piece.front.scalar) /
                               std::max(piece.length, 1e-30));
  if (optics.weight_by_gradient > 0.0f) weight *= std::min(1.0, optics.weight_by_gradient * piece.gradient);
  sum.optical_depth += weight * piece.length * optics.extinction->mean(piece.front, piece.back);
}

/// Adds the surfaces that are met where the scalar goes from one value to another without turning.
inline void add_surfaces(const ShadowOptics& optics, double scalar_front, double scalar_back, Transmission& sum) {
  for (const SurfaceSheet& sheet : optics.surfaces) {
    const bool before = scalar_front < sheet.value, after = scalar_back < sheet.value;
    const bool is_seen = before != after && (before || sheet.is_two_sided);  // rising shows the front, as to the eye
    if (is_seen) sum.through_surfaces *= 1.0 - static_cast<double>(sheet.opacity);
  }
}

/// Calls visit(begin, end) for what of [z_front, z_back] lies in one of `kept`.
template <class Visit>
void visit_kept(std::span<const DepthRange> kept, double z_front, double z_back, const Visit& visit) {
  for (const DepthRange& range : kept) {
    const double begin = std::max(z_front, range.begin), end = std::min(z_back, range.end);
    if (begin < end) visit(begin, end);
  }
}

/// Something that absorbs. Safe to use from many threads.
class ShadowMedium {
 public:
  virtual ~ShadowMedium() = default;

  /// Prepares for many lines that run along `travel` (local): those of the light with that number.
  virtual void expect_parallel(std::size_t /*light*/, const Vector3& /*travel*/) {}

  /// Adds what absorbs along `line` within `kept` (sorted, none beyond the place), until it is dark.
  virtual void gather(const ShadowLine& line, std::span<const DepthRange> kept, Transmission& sum) const = 0;
};

/// Where places lie.
struct ShadowFrame {
  scene::CameraFrame camera;
  Vector3 origin{};  ///< world position of the local origin
  double world_per_local = 1.0;
};

/// The rays of a frame. Views medium and clip volumes; not to be moved while kernels use its lights.
class ShadowRays {
 public:
  ShadowRays(const ShadowFrame& frame, ShadowMedium& medium, const Clipping& clipping,
             std::span<const PreparedGrid* const> clip_volumes);

  /// Makes the lights of a frame ask these rays. `lights`: as `illustrate` made them from `lighting`.
  /// Once `cancelled` is true they let everything through: the picture is given up.
  void attach(const std::vector<Light>& lighting, std::span<LightSource> lights,
              const std::atomic<bool>* cancelled = nullptr);

  /// Part of the light number `light` that reaches a place of the camera frame, in [0, 1].
  float trace(std::size_t light, const float place[3]) const;

  /// Throws what a ray that kernels asked for has failed with, if any did. After the last tile.
  void rethrow_failure() const;

 private:
  /// A light in the local frame.
  struct Source {
    const ShadowRays* rays = nullptr;
    std::size_t number = 0;
    bool is_near = false;
    Vector3 vector{};  ///< where it is, or the unit vector in which it travels
  };
  struct Scratch {
    std::array<ClipScratch, 3> clip;
    std::vector<ClipInterval> intervals;
    std::vector<DepthRange> kept;
  };

  void note_failure(const std::exception_ptr& failure) const;
  Vector3 local_from_camera(const Vector3& seen) const;
  void find_kept(const ShadowLine& line, double z_light, Scratch& scratch) const;

  ShadowFrame frame_;
  ShadowMedium* medium_;
  std::array<ClipScene, 3> clips_;  ///< for lines along each local axis; empty without clipping
  bool has_clipping_ = false;
  std::vector<Source> sources_;
  const std::atomic<bool>* cancelled_ = nullptr;
  mutable tbb::enumerable_thread_specific<Scratch> scratches_;
  mutable std::mutex failure_mutex_;
  mutable std::exception_ptr failure_;
};

}  // namespace tetravox::cpu
