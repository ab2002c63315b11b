#pragma once

/// What is drawn beside emission and absorption, as the kernels want it. Camera frame (src/cpu/frame.h), stored
/// scalars.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tetravox::cpu {

/// A part of a ray that is drawn, by depth.
struct ClipInterval {
  float z_near = 0.0f, z_far = 0.0f;
};

/// Optical depths towards a light at the points of a lattice in the light's own frame (cf. Lokovic and Veach 2000).
///
/// A place p of the camera frame is q = light_from_camera * (p, 1); from a near light q_x, q_y are then divided by q_z.
/// Its lattice coordinates are scale * q + offset.
struct ShadowMap {
  float light_from_camera[12] = {};
  float scale[3] = {}, offset[3] = {};
  bool is_perspective = false;
  std::int32_t sizes[3] = {1, 1, 1};
  const float* depths = nullptr;  ///< [sizes[2]][sizes[1]][sizes[0]]
};

struct LightSource {
  enum class Kind { kHeadlight, kDirectional, kPoint };
  Kind kind = Kind::kHeadlight;
  float vector[3] = {};                ///< kDirectional: unit vector towards the light; kPoint: where it is
  float color[3] = {};                 ///< times intensity
  std::span<const ShadowMap> shadows;  ///< none: it reaches everything; of a near light, one for each face of a cube
  /// Exact shadows instead (src/cpu/shadow_rays.h): the part of the light that reaches a place of the camera frame.
  float (*trace_ray)(const void* context, const float place[3]) noexcept = nullptr;
  const void* ray_context = nullptr;

  bool has_shadows() const { return trace_ray != nullptr || !shadows.empty(); }
};

/// How much of the surroundings is seen from a place, over all directions, and about where: at the points of a lattice.
struct OcclusionMap {
  float lattice_from_camera[12] = {};
  float world_from_camera[9] = {};  ///< of directions
  std::int32_t sizes[3] = {1, 1, 1};
  const float* visibility = nullptr;  ///< [z][y][x][4]: first moments along the world's axes, mean
};

/// Colours over directions at the nodes of a cube (see DirectionTable in optics/environment_filter.h).
struct DirectionMap {
  std::int32_t size = 0;          ///< nodes a side
  const float* colors = nullptr;  ///< [6][size][size][4]
};

/// Light of the surroundings, filtered.
struct EnvironmentMaps {
  float map_from_camera[9] = {};   ///< of directions
  DirectionMap diffuse, specular;  ///< by normal; by reflected view
  float mean[3] = {};              ///< over all directions
  float intensity = 1.0f;          ///< of all of these
};

struct Shading {
  std::span<const LightSource> lights;
  const OcclusionMap* occlusion = nullptr;
  const EnvironmentMaps* environment = nullptr;
  float ambient = 0.0f, diffuse = 1.0f, specular = 0.0f, shininess = 1.0f;
  float half_strength = 0.0f;  ///< square of the gradient magnitude at which shading has half its strength
  bool is_two_sided = true;
  float shadow_bias = 0.0f;  ///< local length by which surfaces are moved towards the light before they are looked up
  float ray_bias = 0.0f;     ///< the same before a ray is traced
};

struct SurfaceSheet {
  float value = 0.0f;
  float front_color[3] = {}, back_color[3] = {};
  float opacity = 1.0f;
  bool is_two_sided = true;
};

/// Moments of the extinction over the scalar: where in a segment its emission lies (see optics/centroid_table.h).
struct CentroidView {
  float first = 0.0f, nodes_per_scalar = 0.0f;
  std::int32_t last_node = 0;
  const std::int32_t* sums = nullptr;  ///< [last_node + 1][4]: extinction, times place, times its square; change
  ///< of colour; all up to the node
};

/// Optical depths of rays at equal steps of depth, written down as they pass.
struct DepthRecord {
  float* depths = nullptr;  ///< [slices][height][width]; places that no ray has passed keep what they hold
  int slices = 0, width = 0, height = 0;
  float z_first = 0.0f, slices_per_z = 0.0f;
};

/// Errors of light looked up in two places, in parts of what the light of a stretch may err by: by the angle between
/// the two normals where colours change, by its third power where emission is uneven, by its fourth power everywhere.
struct LightChange {
  float first = 0.0f, third = 0.0f, fourth = 0.0f;
  /// Of light taken as the mean of that at the two ends: by the square of the angle; by the change of diffuse light and
  /// of the shine from end to end (see EyeLight).
  float second = 0.0f, diffuse = 0.0f, shine = 0.0f;
};

struct Effects {
  const Shading* shading = nullptr;  ///< null: unlit
  bool is_whole = false;  ///< whether no segment of the frame is clipped, by shapes or the eye, nor meets a surface
  std::span<const SurfaceSheet> surfaces;  ///< by ascending value
  CentroidView centroid;
  float camera_from_gradient[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row major; into stored scalars a local length
  float weight_by_change = 0.0f;  ///< extinction is multiplied by that times |scalar change| / world length, at most 1
  float weight_by_gradient = 0.0f;  ///< by that times gradient magnitude (stored scalars a local length), at most 1
  float faint = 0.0f;               ///< opacity that is not worth a normal
  float usual_light = 1.0f;         ///< what it is lit with instead
  float lit_once = 0.0f;            ///< what a stretch may absorb and be lit in one place
  LightChange light_change;
  float longest_lit = 0.0f;  ///< local length that is lit as its middle is, for shadows; 0: any
  float largest_lit = 0.0f;  ///< opacity that is lit as its middle is, for exact shadows; 0: any
  float* depth = nullptr;    ///< [height][width] of the picture: see Image::depth; in local lengths from `z_eye`
  const DepthRecord* record = nullptr;
};

}  // namespace tetravox::cpu
