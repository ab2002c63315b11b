#pragma once

/// Optical depths towards lights, and how open places are: both from pictures that record depths instead of colours.

#include "src/cpu/kernels/effects.h"
#include "src/scene/camera_frame.h"
#include "src/support/threads.h"
#include "tetravox/render.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace tetravox::cpu {

/// Where the data lie.
struct ShadowedBody {
  std::array<ValueRange, 3> bounds;  ///< world
  Vector3 origin{};                  ///< world position of the local origin
  double world_per_local = 1.0;
};

/// Depths that a light sees: at pixels of a square picture from its place, at equal steps along its view.
struct LightDepths {
  Camera camera;
  scene::CameraFrame frame;
  int size = 0;  ///< pixels a side, and steps
  float z_first = 0.0f, slices_per_z = 0.0f;
  std::vector<float> depths;  ///< [size][size][size]: step, row, column
};

/// The data seen by a light: a frame that writes optical depths down.
struct LightPass {
  Camera camera;
  RenderSettings settings;
  DepthRecord record;
};
/// Draws a pass; nobody looks at the colours.
using DrawDepths = std::function<void(const LightPass& pass, Image& unseen)>;

/// What each light sees (none for lights without shadows), for `Lighting::shadows` = kVolume.
std::vector<std::vector<LightDepths>> find_light_depths(const RenderSettings& settings, const ShadowedBody& body,
                                                        const Camera& eye, const DrawDepths& draw);

/// The map of a light's depths for places in the frame of another camera. Views `depths`.
ShadowMap make_shadow_map(const LightDepths& depths, const scene::CameraFrame& camera);

/// How open each place of a lattice over the bounds is: the mean of what comes through over all directions, and its
/// first moments along the world's axes.
///
/// Directions are a low-discrepancy sequence over the sphere (Halton 1960), turned by the seed: more of them only add
/// to the fewer (Zhukov, Iones, Kronin 1998 for the idea of ambient occlusion).
struct Openness {
  std::array<std::int32_t, 3> sizes{};
  std::vector<float> records;  ///< [z][y][x][4]: moments, mean
};
Openness find_openness(const RenderSettings& settings, const ShadowedBody& body, const DrawDepths& draw,
                       const Progress& progress);

/// The map of an openness for places in the frame of a camera. Views `openness`.
OcclusionMap make_occlusion_map(const Openness& openness, const ShadowedBody& body, const scene::CameraFrame& camera);

/// Local length from ray to ray of a light, and from step to step along it, about.
float find_shadow_step(const RenderSettings& settings, const ShadowedBody& body);

}  // namespace tetravox::cpu
