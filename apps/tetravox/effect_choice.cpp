#include "apps/tetravox/effect_choice.h"

#include "tetravox/environment.h"
#include "tetravox/error.h"
#include "tetravox/grid.h"
#include "tetravox/io.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace tetravox::tool {
namespace {

void override_environment(const EffectOptions& options, std::optional<EnvironmentLight>& environment) {
  if (options.environment) {
    environment.reset();
    if (!options.environment->empty()) environment = EnvironmentLight{.file = *options.environment};
  }
  if (!environment) return;
  environment->intensity = options.environment_intensity.value_or(environment->intensity);
  environment->rotation = options.environment_rotation.value_or(environment->rotation);
  environment->up = options.environment_up.value_or(environment->up);
}

void override_lighting(const EffectOptions& options, Lighting& lighting) {
  if (options.lights) lighting.lights = *options.lights;
  override_environment(options, lighting.environment);
  lighting.material = options.material.value_or(lighting.material);
  lighting.gradient = options.gradient.value_or(lighting.gradient);
  lighting.gradient_threshold = options.gradient_threshold.value_or(lighting.gradient_threshold);
  lighting.is_two_sided = options.is_two_sided.value_or(lighting.is_two_sided);
  lighting.shadows = options.shadows.value_or(lighting.shadows);
  lighting.shadow_resolution = options.shadow_resolution.value_or(lighting.shadow_resolution);
  lighting.translucency = options.translucency.value_or(lighting.translucency);
  lighting.translucency_angle = options.translucency_angle.value_or(lighting.translucency_angle);
  lighting.ambient_occlusion = options.ambient_occlusion.value_or(lighting.ambient_occlusion);
  // Surroundings are light enough, unless the headlight is asked for by its name.
  const bool is_dark = lighting.lights.empty() && (!lighting.environment || options.use_headlight);
  if (options.wants_light() && !options.lights && is_dark) lighting.lights.emplace_back();
}

void override_surfaces(const EffectOptions& options, std::vector<Isosurface>& surfaces) {
  if (options.surfaces) {
    surfaces.clear();
    for (const SurfaceOption& option : *options.surfaces)
      surfaces.push_back({.value = option.value, .opacity = option.opacity});
  }
  // What is said of all surfaces holds for those of the scene, too.
  for (Isosurface& surface : surfaces) {
    if (options.are_surfaces_one_sided) surface.is_two_sided = false;
    surface.back_color = options.surface_back_color.value_or(surface.back_color);
  }
}

}  // namespace

void override_effects(const EffectOptions& options, Scene& scene) {
  RenderSettings& settings = scene.settings;
  override_lighting(options, settings.lighting);
  override_surfaces(options, settings.surfaces);
  settings.clipping.shapes = options.clip_shapes.value_or(settings.clipping.shapes);
  settings.clipping.use_union = options.use_union.value_or(settings.clipping.use_union);
  settings.opacity_weight = options.weight.value_or(settings.opacity_weight);
  settings.opacity_weight_scale = options.weight_scale.value_or(settings.opacity_weight_scale);
  try {
    validate_lighting(settings.lighting);
  } catch (const Error& error) {
    throw UsageError(error.what());
  }
}

void complete_effects(const EffectOptions& options, CompletedScene& completed, Scene& scene) {
  RenderSettings& settings = scene.settings;
  for (std::size_t i = 0; options.surfaces && i < options.surfaces->size(); ++i) {
    const SurfaceOption& option = (*options.surfaces)[i];
    Isosurface& surface = settings.surfaces[i];
    surface.front_color =
        option.color ? *option.color : eval_optical_function(completed.optical_function, option.value).color;
    surface.back_color = options.surface_back_color.value_or(surface.front_color);
  }
  if (options.shows_volume && !*options.shows_volume) {
    for (ControlPoint& point : completed.transfer_function.points) point.absorption = 0.0;
    for (OpticalPoint& point : completed.optical_function.points) point.extinction = 0.0;
  }
}

std::vector<std::string> check_effects(const EffectOptions& options, const RenderSettings& settings) {
  std::vector<std::string> lines;
  if (settings.surfaces.empty() && (options.surface_back_color || options.are_surfaces_one_sided))
    lines.push_back("--isosurface-back-color and --one-sided change nothing: there is no --isosurface");
  const Lighting& lighting = settings.lighting;
  if (!lighting.environment &&
      (options.environment_intensity || options.environment_rotation || options.environment_up))
    lines.push_back("--environment-intensity, -rotation and -up change nothing: there is no --environment");
  if (lighting.lights.empty() && lighting.environment &&
      options.shadows.value_or(ShadowKind::kNone) != ShadowKind::kNone)
    lines.push_back(
        "--shadows changes nothing: surroundings throw none, and there are no other lights; --ambient-occlusion "
        "darkens hollows");
  const bool is_half_angle = lighting.shadows == ShadowKind::kHalfAngle;
  if (options.shadow_resolution && !is_half_angle && lighting.shadows != ShadowKind::kVolume &&
      lighting.ambient_occlusion == 0)
    lines.push_back(
        "--shadow-resolution changes nothing: it is for --shadows volume, half-angle and --ambient-occlusion");
  if ((options.translucency || options.translucency_angle) && !is_half_angle)
    lines.push_back("--translucency and -angle change nothing: they are for --shadows half-angle");
  else if (options.translucency_angle && lighting.translucency == 0.0)
    lines.push_back("--translucency-angle changes nothing: there is no --translucency");
  if (settings.clipping.shapes.size() < 2 && options.use_union)
    lines.push_back("--clip-combine changes nothing: there are no two shapes to combine");
  if (settings.opacity_weight == OpacityWeight::kNone && options.weight_scale)
    lines.push_back("--opacity-weight-scale changes nothing: there is no --opacity-weight");
  return lines;
}

void SceneParts::load(const Scene& scene, double reader_timeout, const Progress& progress) {
  const RenderSettings& settings = scene.settings;
  for (std::size_t i = 0; i < settings.clipping.shapes.size(); ++i) {
    const auto* volume = std::get_if<ClipVolume>(&settings.clipping.shapes[i].shape);
    if (!volume) continue;
    ReadOptions read;
    read.array.name = volume->array;
    read.timeout = reader_timeout;
    const Dataset dataset = read_dataset(volume->file, read, progress);
    if (!dataset.is_grid())
      throw Error(ErrorCode::kUnsupported, "'" + volume->file + "' is a mesh: a clip volume must be a grid");
    volumes_.push_back({i, std::make_unique<PreparedGrid>(prepare_grid(dataset.grid, progress))});
  }
  if (const auto& environment = settings.lighting.environment)
    environment_ = std::make_unique<Environment>(read_environment(environment->file));
}

void SceneParts::attach(Renderer& renderer) const {
  for (const Volume& volume : volumes_) renderer.set_clip_volume(volume.shape, *volume.grid);
  if (environment_) renderer.set_environment(*environment_);
}

}  // namespace tetravox::tool
