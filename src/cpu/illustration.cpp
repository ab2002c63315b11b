#include "src/cpu/illustration.h"

#include "src/scene/fixed_rate.h"
#include "tetravox/error.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

namespace tetravox::cpu {
namespace {

/// A piece of a ray is worth a normal if its opacity exceeds this part of the tolerance.
constexpr double kFaintOfTolerance = 1.0 / 200.0;

/// What is fainter is lit with about what most places get.
constexpr float kUsualLight = 0.75f;

/// Of the shadows' lattice: by how many steps surfaces are moved off themselves, and how many are lit as their middle.
constexpr float kBiasInSteps = 1.5f, kLitInSteps = 1.5f;

/// Of the tolerance: by how much the light of one stretch may err. Errors of many stretches hardly add up.
constexpr double kTurningOfTolerance = 1.0 / 3.0;
/// Of exact shadows: by what local length surfaces are moved off themselves; what opacity may be lit as its middle is,
/// at the default tolerance and at most (half of that is what the end of a sharp shadow may be off, its square what a
/// bend of the light may); and how much less than the tolerance need not come through.
constexpr float kRayBias = 1e-4f;
constexpr double kLitAlike = 0.02, kUsualTolerance = 2e-3, kDarkOfTolerance = 1e-2;

LightSource make_light(const Light& light, const IllustratedFrame& frame) {
  LightSource source;
  for (int channel = 0; channel < 3; ++channel)
    source.color[channel] = static_cast<float>(light.color[channel] * light.intensity);
  Vector3 vector{};
  if (light.kind == LightKind::kDirectional) {
    source.kind = LightSource::Kind::kDirectional;
    const double length = std::hypot(light.direction[0], light.direction[1], light.direction[2]);
    for (int axis = 0; axis < 3; ++axis) vector[axis] = -light.direction[axis] / length;
  } else if (light.kind == LightKind::kPoint) {
    source.kind = LightSource::Kind::kPoint;
    for (int axis = 0; axis < 3; ++axis)
      vector[axis] = (light.position[axis] - frame.origin[axis]) / frame.world_per_local;
  }
  const Vector3 seen = to_camera(frame.camera, vector);
  for (int axis = 0; axis < 3; ++axis) source.vector[axis] = static_cast<float>(seen[axis]);
  return source;
}

SurfaceSheet make_sheet(const Isosurface& surface, const optics::ScalarMap& map) {
  SurfaceSheet sheet;
  sheet.value = map.stored_from_value(surface.value);
  for (int channel = 0; channel < 3; ++channel) {
    sheet.front_color[channel] = static_cast<float>(surface.front_color[channel]);
    sheet.back_color[channel] = static_cast<float>(surface.back_color[channel]);
  }
  sheet.opacity = static_cast<float>(surface.opacity);
  sheet.is_two_sided = surface.is_two_sided;
  return sheet;
}

/// Directions of the camera frame -> those of the environment, and what it holds there.
EnvironmentMaps make_environment_maps(const EnvironmentLight& light, const optics::FilteredEnvironment& filtered,
                                      const scene::CameraFrame& camera) {
  EnvironmentMaps maps;
  const std::array<Vector3, 3> axes = environment_axes(light.up, light.rotation);
  for (std::size_t row = 0; row < 3; ++row) {
    const Vector3 seen = to_camera(camera, axes[row]);
    for (std::size_t column = 0; column < 3; ++column)
      maps.map_from_camera[3 * row + column] = static_cast<float>(seen[column]);
    maps.mean[row] = filtered.mean[row];
  }
  maps.diffuse = {filtered.diffuse.size, filtered.diffuse.records.data()};
  maps.specular = {filtered.specular.size, filtered.specular.records.data()};
  maps.intensity = static_cast<float>(light.intensity);
  return maps;
}

void fill_shading(const Lighting& lighting, const IllustratedFrame& frame, Illustration& illustration) {
  for (const Light& light : lighting.lights) illustration.lights.push_back(make_light(light, frame));
  Shading& shading = illustration.shading;
  shading.lights = illustration.lights;
  if (lighting.environment) {
    illustration.environment = make_environment_maps(*lighting.environment, *frame.environment, frame.camera);
    shading.environment = &illustration.environment;
  }
  shading.ambient = static_cast<float>(lighting.material.ambient);
  shading.diffuse = static_cast<float>(lighting.material.diffuse);
  shading.specular = static_cast<float>(lighting.material.specular);
  shading.shininess = static_cast<float>(lighting.material.shininess);
  shading.is_two_sided = lighting.is_two_sided;
  const double range = frame.scalar_range.max - frame.scalar_range.min;
  const double magnitude = lighting.gradient_threshold * range / frame.diagonal;  // value a world length
  const double stored = magnitude * frame.world_per_local / frame.scalar_map.scale;
  shading.half_strength = static_cast<float>(stored * stored);
}

/// What the light of one stretch may err by, and how. A homogeneous stretch that turns by x errs by x^2 / 24 times the
/// second derivative of light by the angle in one place, by x^4 / 4320 times the fourth in two, which are 0.58 of its
/// length apart; one with two peaks by a third of the cube of half the angle between the places, times the third;
/// colours that change half way by a quarter of that angle, times the first.
void limit_light_error(const Lighting& lighting, double tolerance, Effects& effects) {
  const double allowed = kTurningOfTolerance * tolerance;
  double brightness = 0.0;
  for (const Light& light : lighting.lights)
    brightness += light.intensity * std::max({light.color[0], light.color[1], light.color[2]});
  if (lighting.environment) brightness += lighting.environment->intensity;
  // What is open to a side changes with the normal as diffuse light does.
  const double ambient = lighting.ambient_occlusion > 0 ? lighting.material.ambient : 0.0;
  const double diffuse = (brightness * lighting.material.diffuse + ambient) / allowed;
  const double specular = brightness * lighting.material.specular / allowed;
  // Near its top cos^N is exp(-N x^2 / 2), whose derivatives are largest at these values.
  const double n = lighting.material.shininess, root = std::sqrt(n);
  effects.lit_once = static_cast<float>(24.0 / std::max(diffuse + specular * n, 1e-30));
  effects.light_change.second = static_cast<float>((diffuse + specular * n) / 8.0);
  effects.light_change.diffuse = static_cast<float>(brightness * lighting.material.diffuse / allowed / 2.0);
  effects.light_change.shine = static_cast<float>(brightness / allowed / 2.0);
  effects.light_change.first = static_cast<float>((diffuse + 0.61 * specular * root) / 4.0);
  effects.light_change.third = static_cast<float>((diffuse + 1.38 * specular * n * root) / 24.0);
  effects.light_change.fourth = static_cast<float>((diffuse + 3.0 * specular * n * n) / 480.0);
}

/// Everything that what `lights` see depends on, as text.
std::string shadow_key(const RenderSettings& settings, const Lighting& lights, const ShadowCache::Sources& sources) {
  const bool follows_eye = std::any_of(lights.lights.begin(), lights.lights.end(),
                                       [](const Light& light) { return light.kind == LightKind::kHeadlight; });
  Scene scene;
  scene.settings = settings;
  scene.settings.width = scene.settings.height = 1;
  scene.settings.samples_per_voxel = 0.0;  // as lights draw
  scene.settings.lighting = lights;
  if (follows_eye) scene.camera = sources.eye;
  return format_scene(scene) + std::to_string(sources.function) + ", " + std::to_string(sources.clip_volumes);
}

bool wants_more_than_light(const RenderSettings& settings) {
  return !settings.surfaces.empty() || settings.wants_depth || settings.opacity_weight != OpacityWeight::kNone;
}

}  // namespace

void ShadowCache::prepare(const RenderSettings& settings, const Sources& sources, const DrawDepths& draw,
                          const Progress& progress) {
  const Lighting& lighting = settings.lighting;
  if (lighting.shadows == ShadowKind::kVolume) {
    Lighting seen;
    seen.lights = lighting.lights;
    seen.shadow_resolution = lighting.shadow_resolution;
    seen.gradient = lighting.gradient;
    const std::string key = shadow_key(settings, seen, sources);
    if (key != key_) {
      key_.clear();
      lights_ = find_light_depths(settings, sources.body, sources.eye, draw);
      key_ = key;
    }
  }
  if (lighting.ambient_occlusion > 0) {
    Lighting seen;
    seen.shadow_resolution = lighting.shadow_resolution;
    seen.gradient = lighting.gradient;
    seen.ambient_occlusion = lighting.ambient_occlusion;
    seen.occlusion_seed = lighting.occlusion_seed;
    const std::string key = shadow_key(settings, seen, sources);
    if (key != openness_key_) {
      openness_key_.clear();
      openness_ = cpu::find_openness(settings, sources.body, draw, progress);
      openness_key_ = key;
    }
  }
}

std::uint64_t ShadowCache::bytes() const {
  std::uint64_t floats = openness_.records.size();
  for (const std::vector<LightDepths>& light : lights_)
    for (const LightDepths& view : light) floats += view.depths.size();
  return floats * sizeof(float);
}

void ShadowCache::attach(const RenderSettings& settings, const ShadowedBody& body, const scene::CameraFrame& camera,
                         Illustration& illustration) const {
  Shading& shading = illustration.shading;
  const float step = find_shadow_step(settings, body);
  shading.shadow_bias = kBiasInSteps * step;
  if (settings.lighting.shadows == ShadowKind::kVolume || settings.lighting.ambient_occlusion > 0)
    illustration.effects.longest_lit = kLitInSteps * step;
  if (settings.lighting.shadows == ShadowKind::kVolume) {
    for (const std::vector<LightDepths>& light : lights_) {
      std::vector<ShadowMap>& maps = illustration.shadows.emplace_back();
      for (const LightDepths& depths : light) maps.push_back(make_shadow_map(depths, camera));
    }
    for (std::size_t i = 0; i < illustration.lights.size(); ++i)
      illustration.lights[i].shadows = illustration.shadows[i];
  }
  if (settings.lighting.ambient_occlusion > 0) {
    illustration.occlusion = make_occlusion_map(openness_, body, camera);
    shading.occlusion = &illustration.occlusion;
  }
}

ShadowOptics make_shadow_optics(const RenderSettings& settings, const optics::ExtinctionIntegral& extinction,
                                const Illustration& illustration) {
  const Effects& effects = illustration.effects;
  return {&extinction, effects.surfaces, effects.weight_by_change, effects.weight_by_gradient,
          -std::log(kDarkOfTolerance * settings.tolerance)};
}

void trace_shadows(const RenderSettings& settings, const ShadowFrame& frame, const scene::FrameContext& context,
                   Illustration& illustration) {
  illustration.rays =
      std::make_unique<ShadowRays>(frame, *illustration.medium, settings.clipping, context.clip_volumes);
  illustration.rays->attach(settings.lighting.lights, illustration.lights, context.progress.cancelled);
  illustration.shading.ray_bias = kRayBias;
  const double fineness = std::sqrt(std::min(1.0, settings.tolerance / kUsualTolerance));
  illustration.effects.largest_lit = static_cast<float>(kLitAlike * fineness);
}

Vector3 to_camera(const scene::CameraFrame& camera, const Vector3& direction) {
  Vector3 seen{};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) seen[axis] += camera.axes[axis][i] * direction[i];
  return seen;
}

bool wants_effects(const RenderSettings& settings) {
  return settings.lighting.is_lit() || wants_more_than_light(settings);
}

bool wants_gradients(const RenderSettings& settings) {
  return settings.lighting.is_lit() || settings.opacity_weight == OpacityWeight::kGradient;
}

void require_effects(const RenderSettings& settings, bool has_constant_cells) {
  const auto fail = [](const std::string& message) { throw Error(ErrorCode::kUnsupported, message); };
  if (settings.integrator == Integrator::kPre)
    fail(
        "pre-classification goes with clipping, but not with light, iso-surfaces, weights or depth: choose another "
        "classification");
  if (has_constant_cells && !settings.surfaces.empty())
    fail("iso-surfaces need a field that is continuous: choose point data, or another filter than 'nearest'");
}

void require_rate_effects(const PreparedGrid& grid, const RenderSettings& settings) {
  if (settings.samples_per_voxel == 0.0) return;
  const auto fail = [](const std::string& message) {
    throw Error(ErrorCode::kUnsupported, message + ": draw without one (--samples-per-voxel auto)");
  };
  if (wants_more_than_light(settings)) fail("iso-surfaces, weights and depth follow the cells, not a fixed rate");
  const std::string obstacle = scene::find_obstacle_to_counting(grid, settings);
  if (!obstacle.empty()) fail("light at a fixed rate needs " + obstacle);
}

void illustrate(const RenderSettings& settings, const IllustratedFrame& frame, Illustration& illustration) {
  Effects& effects = illustration.effects;
  if (settings.lighting.is_lit()) {
    fill_shading(settings.lighting, frame, illustration);
    effects.shading = &illustration.shading;
  }
  for (const Isosurface& surface : settings.surfaces)
    illustration.sheets.push_back(make_sheet(surface, frame.scalar_map));
  std::stable_sort(illustration.sheets.begin(), illustration.sheets.end(),
                   [](const SurfaceSheet& a, const SurfaceSheet& b) { return a.value < b.value; });
  effects.surfaces = illustration.sheets;
  for (std::size_t i = 0; i < 9; ++i)
    effects.camera_from_gradient[i] = static_cast<float>(frame.camera_from_gradient[i]);
  if (frame.centroids)
    effects.centroid = {frame.centroids->first, frame.centroids->nodes_per_scalar, frame.centroids->last_node,
                        frame.centroids->sums.data()};
  const double range = std::max(frame.scalar_range.max - frame.scalar_range.min, 1e-300);
  const double weight = settings.opacity_weight_scale * frame.scalar_map.scale * frame.diagonal / range;
  if (settings.opacity_weight == OpacityWeight::kScalarDifference)
    effects.weight_by_change = static_cast<float>(weight);
  if (settings.opacity_weight == OpacityWeight::kGradient)
    effects.weight_by_gradient = static_cast<float>(weight / frame.world_per_local);
  if (effects.shading) {
    effects.usual_light = kUsualLight;
    limit_light_error(settings.lighting, settings.tolerance, effects);
  }
  effects.faint = static_cast<float>(settings.tolerance * kFaintOfTolerance);
}

}  // namespace tetravox::cpu
