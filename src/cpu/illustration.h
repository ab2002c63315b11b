#pragma once

/// The effects of a frame: what RenderSettings ask for beside emission and absorption, as the kernels want it.

#include "src/cpu/kernels/effects.h"
#include "src/cpu/shadow_rays.h"
#include "src/cpu/shadows.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/centroid_table.h"
#include "src/optics/environment_filter.h"
#include "src/scene/brick_plan.h"
#include "src/scene/camera_frame.h"
#include "src/scene/frame_renderer.h"
#include "tetravox/render.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tetravox::cpu {

/// Data and camera of a frame.
struct IllustratedFrame {
  scene::CameraFrame camera;
  Vector3 origin{};  ///< world position of the local origin
  double world_per_local = 1.0;
  optics::ScalarMap scalar_map;
  ValueRange scalar_range;  ///< values
  double diagonal = 1.0;    ///< of the bounds, world length
  /// Row major: gradients as the source holds them -> camera frame, stored scalars a local length.
  std::array<double, 9> camera_from_gradient{};
  const optics::CentroidTable* centroids = nullptr;
  const optics::FilteredEnvironment* environment = nullptr;  ///< where the lighting has one
};

/// Owns what `effects` points at: not to be moved.
struct Illustration {
  Illustration() = default;
  Illustration(const Illustration&) = delete;
  Illustration& operator=(const Illustration&) = delete;

  std::vector<LightSource> lights;
  std::vector<std::vector<ShadowMap>> shadows;  ///< of each light
  std::vector<scene::BrickPlan> shadow_plans;   ///< for exact shadows in grids
  std::unique_ptr<ShadowMedium> medium;         ///< for exact shadows
  std::unique_ptr<ShadowRays> rays;
  OcclusionMap occlusion;
  EnvironmentMaps environment;
  std::vector<SurfaceSheet> sheets;
  Shading shading;
  Effects effects;
};

/// Whether anything but the clipping goes beyond emission and absorption.
bool wants_effects(const RenderSettings& settings);

/// Whether these need gradients.
bool wants_gradients(const RenderSettings& settings);

/// @throws Error (kUnsupported) for settings that do not go together.
void require_effects(const RenderSettings& settings, bool has_constant_cells);

/// @throws Error (kUnsupported) where they do not go with a fixed rate through this grid, if there is one.
void require_rate_effects(const PreparedGrid& grid, const RenderSettings& settings);

/// Fills all but shadows, occlusion, depth and record.
void illustrate(const RenderSettings& settings, const IllustratedFrame& frame, Illustration& illustration);

/// The extinction, surfaces and weights of an illustration that is filled, for exact shadows.
ShadowOptics make_shadow_optics(const RenderSettings& settings, const optics::ExtinctionIntegral& extinction,
                                const Illustration& illustration);

/// Lights the frame through `illustration.medium` by rays. Views the context's clip volumes.
void trace_shadows(const RenderSettings& settings, const ShadowFrame& frame, const scene::FrameContext& context,
                   Illustration& illustration);

/// What lights see, from frame to frame as long as nothing changes.
class ShadowCache {
 public:
  /// What shadows depend on beside the settings.
  struct Sources {
    ShadowedBody body;
    Camera eye;
    std::uint64_t function = 0;      ///< changes with the transfer function,
    std::uint64_t clip_volumes = 0;  ///< with the grids that clip
  };
  /// Draws what is missing for these settings.
  void prepare(const RenderSettings& settings, const Sources& sources, const DrawDepths& draw,
               const Progress& progress);
  /// Hands it to a frame. Valid as long as this.
  void attach(const RenderSettings& settings, const ShadowedBody& body, const scene::CameraFrame& camera,
              Illustration& illustration) const;
  std::uint64_t bytes() const;

 private:
  std::string key_, openness_key_;
  std::vector<std::vector<LightDepths>> lights_;
  Openness openness_;
};

/// A world direction in the camera frame.
Vector3 to_camera(const scene::CameraFrame& camera, const Vector3& direction);

}  // namespace tetravox::cpu
