#include "src/scene/frame_renderer.h"
#include "src/support/memory.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/error.h"
#include "tetravox/render.h"
#include "tetravox/slicing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tetravox {

namespace {

/// Surroundings, filtered for the material that they light.
struct EnvironmentCache {
  const Environment* environment = nullptr;
  double shininess = 0.0;  ///< that `filtered` is for; 0: none
  optics::FilteredEnvironment filtered = {};

  /// What frames with this lighting need, null where it has no environment.
  const optics::FilteredEnvironment* prepare(const Lighting& lighting) {
    if (!lighting.environment) return nullptr;
    if (!environment)
      throw Error(ErrorCode::kInvalidArgument,
                  "the lighting has the environment '" + lighting.environment->file + "': set it before drawing");
    if (shininess != lighting.material.shininess) {
      shininess = 0.0;
      filtered = optics::filter_environment(*environment, lighting.material.shininess);
      shininess = lighting.material.shininess;
    }
    return &filtered;
  }

  std::uint64_t bytes() const {
    return (filtered.diffuse.records.size() + filtered.specular.records.size()) * sizeof(float);
  }
};

}  // namespace

struct Renderer::State {
  std::unique_ptr<scene::FrameRenderer> frames;
  bool has_function = false, has_table = false;
  std::vector<const PreparedGrid*> clip_volumes = {};
  std::uint64_t clip_number = 0;
  EnvironmentCache environment = {};
};

namespace {

void validate_settings(const RenderSettings& settings) {
  const auto fail = [](const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); };
  const auto in_range = [](int size) { return size >= 1 && size <= kLargestResolution; };
  if (!in_range(settings.width) || !in_range(settings.height))
    fail("resolution " + std::to_string(settings.width) + " x " + std::to_string(settings.height) +
         " is not possible: each side must be between 1 and " + std::to_string(kLargestResolution));
  if (settings.samples < 1 || settings.samples > 4096) fail("samples must be between 1 and 4096");
  if (!(settings.tolerance >= kSmallestTolerance && settings.tolerance <= 1.0))
    fail("tolerance must be between 1e-7 and 1");
  const double rate = settings.samples_per_voxel;
  if (!(rate == 0.0 || (rate >= kLowestRate && rate <= kHighestRate)))
    fail("samples per voxel must be 0 (as the tolerance asks), or from 0.001 to 64");
  if (!(settings.opacity_weight_scale > 0.0)) fail("the scale of the opacity weight must be above 0");
  validate_preintegration(settings.preintegration);
  if (settings.integrator == Integrator::kTable3d && settings.preintegration.scalars > kLargestTableSize)
    fail("scalars of a three-dimensional table: " + std::to_string(settings.preintegration.scalars) +
         " is not between 2 and " + std::to_string(kLargestTableSize));
  validate_lighting(settings.lighting);
  validate_isosurfaces(settings.surfaces);
  validate_clipping(settings.clipping);
  validate_slicing(settings.slicing);
  if (settings.threads < 0 || settings.threads > 4096) fail("threads must be between 0 (all cores) and 4096");
}

void validate_function(const OpticalFunction& function) {
  const auto fail = [](const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); };
  if (function.points.empty()) fail("the transfer function has no points");
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    const OpticalPoint& point = function.points[i];
    const std::string name = "point " + std::to_string(i) + " of the transfer function";
    if (!std::isfinite(point.value)) fail(name + ": the value is not finite");
    if (i > 0 && point.value < function.points[i - 1].value) fail(name + ": values must not descend");
    if (!(point.extinction >= 0.0)) fail(name + ": the extinction is negative or not a number");
    for (const double channel : point.color)
      if (!(channel >= 0.0 && channel <= 1.0)) fail(name + ": colours lie in [0, 1]");
  }
}

/// Float can work with extinctions up to that: what is opaque within a millionth of the diagonal is opaque.
double largest_extinction(double longest) { return 1e6 / std::max(longest, 1e-300); }

OpticalFunction limit_extinction(const OpticalFunction& function, double longest) {
  OpticalFunction limited = function;
  for (OpticalPoint& point : limited.points) point.extinction = std::min(point.extinction, largest_extinction(longest));
  return limited;
}

OpticalTable limit_extinction(const OpticalTable& table, double longest) {
  OpticalTable limited = table;
  for (OpticalPoint& entry : limited.entries)
    entry.extinction = std::min(entry.extinction, largest_extinction(longest));
  return limited;
}

void require_clip_volumes(const Clipping& clipping, const std::vector<const PreparedGrid*>& volumes) {
  for (std::size_t i = 0; i < clipping.shapes.size(); ++i)
    if (std::holds_alternative<ClipVolume>(clipping.shapes[i].shape) && !volumes[i])
      throw Error(ErrorCode::kInvalidArgument,
                  "shape " + std::to_string(i) + " of the clipping is a volume: set its grid before drawing");
}

void require_source(const RenderSettings& settings, const std::vector<Source>& sources) {
  if (settings.lighting.shadows == ShadowKind::kHalfAngle && settings.source != Source::kSlices)
    throw Error(ErrorCode::kUnsupported,
                "shadows 'half-angle' are for grids by the source 'slices' of --backend gl: choose --source slices, or "
                "'volume' or 'exact'");
  if (!settings.source || std::ranges::find(sources, *settings.source) != sources.end()) return;
  const bool is_grid = sources.front() == Source::kMarch;
  const Source asked = *settings.source;
  const bool is_of_grids = asked == Source::kMarch || asked == Source::kSlices;
  std::string names = is_of_grids == is_grid ? "--backend gl for it, or " : "";
  for (const Source source : sources) names += (source == sources.front() ? "'" : ", '") + name_of(source) + "'";
  throw Error(ErrorCode::kInvalidArgument, "source '" + name_of(asked) + "' does not draw " +
                                               (is_grid ? "grids" : "meshes") + " here: choose " + names +
                                               ", or leave it open");
}

}  // namespace

Renderer::Renderer(std::unique_ptr<scene::FrameRenderer> frames) : state_(new State{.frames = std::move(frames)}) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::set_transfer_function(const OpticalFunction& function) {
  validate_function(function);
  state_->frames->set_transfer_function(limit_extinction(function, state_->frames->diagonal()));
  state_->has_function = true;
  state_->has_table = false;
}

void Renderer::set_multidimensional_function(const OpticalTable& table, const std::vector<std::size_t>& others) {
  validate_optical_table(table);
  state_->frames->set_table(limit_extinction(table, state_->frames->diagonal()), others);
  state_->has_function = state_->has_table = true;
}

void Renderer::set_color_function(std::size_t other, const OpticalFunction& colors) {
  validate_function(colors);
  if (!state_->has_function || state_->has_table)
    throw Error(ErrorCode::kInvalidArgument,
                "colours from another array go with the opacities of a transfer function: set that before");
  state_->frames->set_colors(other, colors);
}

Image Renderer::render(const Camera& camera, const RenderSettings& settings, RenderStatistics* statistics,
                       const Progress& progress) {
  validate_settings(settings);
  validate_camera(camera);
  scene::FrameRenderer& frames = *state_->frames;
  require_source(settings, frames.sources());
  if (!state_->has_function) throw Error(ErrorCode::kInvalidArgument, "set a transfer function before drawing");
  support::require_memory(frames.missing_bytes(settings), "drawing this picture");

  const support::Timer timer;
  Image image{settings.width, settings.height, {}, {}};
  RenderStatistics drawn;
  support::with_threads(settings.threads, [&] {
    const std::size_t pixels = static_cast<std::size_t>(settings.width) * settings.height;
    image.pixels.resize(4 * pixels);
    if (settings.wants_depth) image.depth.assign(pixels, std::numeric_limits<float>::infinity());
    std::vector<const PreparedGrid*> volumes = state_->clip_volumes;
    volumes.resize(settings.clipping.shapes.size());
    require_clip_volumes(settings.clipping, volumes);
    const optics::FilteredEnvironment* environment = state_->environment.prepare(settings.lighting);
    frames.render(camera, settings, {progress, volumes, state_->clip_number, environment}, image, drawn);
  });
  drawn.seconds = timer.seconds();
  drawn.threads = settings.threads > 0 ? settings.threads : support::hardware_threads();
  drawn.integrator = frames.has_domain() ? "domain" : name_of(settings.integrator);
  if (statistics) *statistics = drawn;
  return image;
}

void Renderer::set_clip_volume(std::size_t shape, const PreparedGrid& grid) {
  if (state_->clip_volumes.size() <= shape) state_->clip_volumes.resize(shape + 1);
  state_->clip_volumes[shape] = &grid;
  ++state_->clip_number;
}

void Renderer::set_environment(const Environment& environment) {
  validate_environment(environment);
  state_->environment = {.environment = &environment};
}

std::uint64_t Renderer::bytes() const { return state_->frames->bytes() + state_->environment.bytes(); }

double scene::diagonal_of(const std::array<ValueRange, 3>& bounds) {
  return std::hypot(bounds[0].max - bounds[0].min, bounds[1].max - bounds[1].min, bounds[2].max - bounds[2].min);
}

}  // namespace tetravox
