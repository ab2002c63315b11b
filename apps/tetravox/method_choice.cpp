#include "apps/tetravox/method_choice.h"

#include "apps/tetravox/body.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>

namespace tetravox::tool {
namespace {

struct ClassificationEntry {
  Classification value;
  const char* name;
  const char* description;
};

constexpr std::array<ClassificationEntry, 3> kClassifications{
    {{Classification::kPreintegrated, "preintegrated",
      "the function is integrated along each segment: integrators antiderivative (default), partial, table3d, "
      "polynomial, "
      "cylindrical"},
     {Classification::kPost, "post", "the function is looked up at samples: integrator post; for comparison"},
     {Classification::kPre, "pre",
      "grids: the function is looked up at the values, colours are interpolated: integrator pre; for comparison"}}};

Classification classification_of(Integrator integrator) {
  if (integrator == Integrator::kPost) return Classification::kPost;
  if (integrator == Integrator::kPre) return Classification::kPre;
  return Classification::kPreintegrated;
}

/// The integrator that a classification stands for, where nothing says more.
Integrator integrator_of(Classification classification) {
  if (classification == Classification::kPost) return Integrator::kPost;
  if (classification == Classification::kPre) return Integrator::kPre;
  return Integrator::kAntiderivative;
}

/// Says that `what` is for the other kind of data: as an option, or as a key of the scene.
[[noreturn]] void refuse(bool is_option, const std::string& option, const std::string& key, bool is_grid,
                         const std::string& data_name) {
  const std::string text = "is for " + std::string(is_grid ? "meshes" : "grids") + ", and '" + data_name + "' is a " +
                           (is_grid ? "grid" : "mesh") + ": leave it out";
  if (is_option) throw UsageError(option + ": " + text);
  throw Error(ErrorCode::kInvalidArgument, "the scene's render." + key + " " + text);
}

/// Options that change nothing, one line each.
struct UnusedOptions {
  std::vector<std::string> lines;

  void note(bool is_given, bool is_used, const std::string& option, const std::string& reason) {
    if (is_given && !is_used) lines.push_back(option + " changes nothing: " + reason);
  }
};

void check_tables(const PreintegrationOptions& tables, const RenderSettings& settings, UnusedOptions& unused) {
  const Integrator integrator = settings.integrator;
  const auto check = [&](bool is_given, const std::string& option, std::initializer_list<Integrator> users) {
    std::string names;
    for (const Integrator user : users) names += (names.empty() ? "" : ", ") + name_of(user);
    unused.note(is_given, std::find(users.begin(), users.end(), integrator) != users.end(), option,
                "it is for --integrator " + names + ", and this picture is drawn by " + name_of(integrator));
  };
  constexpr Integrator kTable = Integrator::kTable3d, kPolynomial = Integrator::kPolynomial,
                       kCylindrical = Integrator::kCylindrical;
  check(tables.scalars.has_value(), "--preintegration-size", {kTable, kPolynomial});
  check(tables.lengths && integrator == kPolynomial, "the second number of --preintegration-size", {kTable});
  check(tables.length_spacing.has_value(), "--preintegration-lengths", {kTable});
  check(tables.opacity.has_value(), "--preintegration-opacity", {kPolynomial});
  check(tables.planes.has_value(), "--preintegration-planes", {kCylindrical});
  check(tables.tile.has_value(), "--preintegration-tile", {kCylindrical});
  check(tables.steps.has_value(), "--preintegration-steps", {kTable, kPolynomial, kCylindrical});
  check(tables.bits.has_value(), "--preintegration-bits", {kTable, kPolynomial, kCylindrical});
  check(tables.device.has_value(), "--preintegration-device", {kTable, kPolynomial, kCylindrical});
  check(tables.use_incremental.has_value(), "--preintegration-incremental", {kTable, kPolynomial});
  unused.note(tables.use_incremental && (integrator == kTable || integrator == kPolynomial),
              settings.preintegration.device == TableDevice::kCpu, "--preintegration-incremental",
              "it is for --preintegration-device cpu");
}

void check_backend(const MethodOptions& method, bool is_gl, Source source, UnusedOptions& unused) {
  unused.note(method.gl_device.has_value(), is_gl, "--gl-device", "it is for --backend gl");
  unused.note(method.entry_order.has_value(), is_gl && source == Source::kWalk, "--entry-order",
              "it is for meshes by --backend gl and the source walk");
  unused.note(!method.instruction_set.empty(), !is_gl, "--instruction-set", "it is for --backend cpu");
}

void check_slices(const MethodOptions& method, const RenderSettings& settings, Source source, UnusedOptions& unused) {
  const bool is_sliced = source == Source::kSlices;
  const std::string of_slices = "it is for --source slices";
  unused.note(method.slices.has_value(), is_sliced, "--slices", of_slices);
  unused.note(method.slices_per_voxel.has_value(), is_sliced, "--slices-per-voxel", of_slices);
  unused.note(method.slabs.has_value(), is_sliced, "--slabs", of_slices);
  if (!is_sliced) return;
  const bool has_number = settings.slicing.kind != SlicingKind::kObject2d;
  const std::string of_textures = "the slices of object-2d are the 2D textures themselves";
  unused.note(method.slices.has_value(), has_number, "--slices", of_textures);
  unused.note(method.slices_per_voxel.has_value(), has_number, "--slices-per-voxel", of_textures);
  unused.note(method.slices_per_voxel && has_number, settings.slicing.slices == 0, "--slices-per-voxel",
              "--slices says how many there are");
  unused.note(method.slabs.has_value(), classification_of(settings.integrator) == Classification::kPreintegrated,
              "--slabs", "it is for --classification preintegrated");
}

void check_samples(const MethodOptions& method, const RenderSettings& settings, Source source, UnusedOptions& unused) {
  const bool is_post = settings.integrator == Integrator::kPost, is_sliced = source == Source::kSlices;
  const auto note = [&](bool is_used, const std::string& reason) {
    unused.note(method.samples.has_value(), is_used, "--samples", reason);
  };
  note(is_post, "it is for --integrator post, and this picture is drawn by " + name_of(settings.integrator));
  if (!is_post) return;
  note(!is_sliced, "between two slices is one sample; --slices says how many there are");
  note(is_sliced || settings.samples_per_voxel == 0.0, "--samples-per-voxel says where samples are taken");
}

void check_projection(const MethodOptions& method, Source source, UnusedOptions& unused) {
  const bool is_projected = source == Source::kProject, is_either = is_projected || source == Source::kVicp;
  unused.note(method.sort.has_value(), is_either, "--sort", "it is for --source project and vicp");
  unused.note(method.decomposition.has_value(), is_projected, "--decomposition", "it is for --source project");
  unused.note(method.use_pixel_correction.has_value(), is_projected, "--pixel-correction",
              "it is for --source project");
  unused.note(method.transfer.has_value(), is_either, "--mesh-transfer", "it is for --source project and vicp");
}

/// What rays stop at, and what they may be wrong by.
void check_rays(const MethodOptions& method, const RenderSettings& settings, Source source, UnusedOptions& unused) {
  const bool is_mesh = source != Source::kMarch && source != Source::kSlices;
  const bool is_blended =
      source == Source::kSlices || (is_mesh && source != Source::kWalk && settings.projection.sort != CellSort::kExact);
  unused.note(method.use_early_ray_termination.has_value(), !is_blended, "--early-ray-termination",
              "the source " + name_of(source) + " draws all there is" +
                  (is_mesh ? ", unless it sorts segments (--sort exact)" : ""));
  // Slabs, the cells of a mesh and fixed rates are segments as they are, and only `antiderivative` looks at the
  // tolerance inside. But rays through grids also end by it, and light falls on what it says is bright.
  const bool has_fixed_segments = source != Source::kMarch || settings.samples_per_voxel > 0.0;
  const bool ends_by_it = source == Source::kMarch && settings.use_early_ray_termination;
  unused.note(method.tolerance.has_value(),
              settings.integrator == Integrator::kAntiderivative || !has_fixed_segments || ends_by_it ||
                  settings.lighting.is_lit(),
              "--tolerance",
              "the integrator " + name_of(settings.integrator) +
                  (is_mesh                     ? " takes each cell as it is"
                   : source == Source::kSlices ? " takes slabs as they are"
                                               : " with --samples-per-voxel takes segments as they are"));
}

void override_tables(const PreintegrationOptions& tables, PreintegrationSettings& settings) {
  settings.scalars = tables.scalars.value_or(settings.scalars);
  settings.lengths = tables.lengths.value_or(settings.lengths);
  settings.length_spacing = tables.length_spacing.value_or(settings.length_spacing);
  settings.degree = tables.degree.value_or(settings.degree);
  settings.opacity = tables.opacity.value_or(settings.opacity);
  settings.planes = tables.planes.value_or(settings.planes);
  settings.tile = tables.tile.value_or(settings.tile);
  settings.steps = tables.steps.value_or(settings.steps);
  settings.bits = tables.bits.value_or(settings.bits);
  settings.device = tables.device.value_or(settings.device);
  settings.use_incremental = tables.use_incremental.value_or(settings.use_incremental);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> classification_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const ClassificationEntry& entry : kClassifications) names.emplace_back(entry.name, entry.description);
  return names;
}

Classification parse_classification(const std::string& option, const std::string& text) {
  std::vector<std::string> names;
  for (const ClassificationEntry& entry : kClassifications) names.emplace_back(entry.name);
  return kClassifications[parse_choice(option, text, names)].value;
}

void require_consistent(const MethodOptions& method) {
  if (!method.classification || !method.integrator) return;
  const auto& entry = kClassifications[static_cast<std::size_t>(*method.classification)];
  if (classification_of(*method.integrator) != entry.value)
    throw UsageError("--classification " + std::string(entry.name) + " and --integrator " +
                     name_of(*method.integrator) + " contradict each other: leave one out");
}

void override_method(const MethodOptions& method, RenderSettings& settings) {
  if (method.source) {
    settings.source = method.source->source;
    settings.slicing.kind = method.source->slicing;
  }
  settings.slicing.slabs = method.slabs.value_or(settings.slicing.slabs);
  // A number and a rate take each other's place.
  if (method.slices || method.slices_per_voxel) settings.slicing.slices = method.slices.value_or(0);
  settings.slicing.slices_per_voxel = method.slices_per_voxel.value_or(settings.slicing.slices_per_voxel);
  if (method.classification && classification_of(settings.integrator) != *method.classification)
    settings.integrator = integrator_of(*method.classification);
  settings.integrator = method.integrator.value_or(settings.integrator);
  settings.entry_order = method.entry_order.value_or(settings.entry_order);
  override_tables(method.preintegration, settings.preintegration);
  settings.filter = method.filter.value_or(settings.filter);
  settings.samples = method.samples.value_or(settings.samples);
  settings.samples_per_voxel = method.samples_per_voxel.value_or(settings.samples_per_voxel);
  settings.tolerance = method.tolerance.value_or(settings.tolerance);
  settings.use_early_ray_termination = method.use_early_ray_termination.value_or(settings.use_early_ray_termination);
  settings.projection.sort = method.sort.value_or(settings.projection.sort);
  settings.projection.decomposition = method.decomposition.value_or(settings.projection.decomposition);
  settings.projection.use_pixel_correction =
      method.use_pixel_correction.value_or(settings.projection.use_pixel_correction);
  settings.projection.transfer = method.transfer.value_or(settings.projection.transfer);
  settings.threads = method.threads;
  settings.instruction_set = method.instruction_set;
}

bool draws_by_gl(const MethodOptions& method, const RenderSettings& settings, std::optional<Association> association) {
  if (method.use_gl) return *method.use_gl;
  using enum Source;
  using enum Integrator;
  const Integrator integrator = settings.integrator;
  const bool is_by_table = integrator == kTable3d || integrator == kPolynomial || integrator == kCylindrical;
  const FilterKind filter = settings.filter.kind;
  const bool is_constant =
      filter == FilterKind::kNearest || (association == Association::kCell && filter == FilterKind::kLinear);
  if (is_by_table && !is_constant && settings.preintegration.device == TableDevice::kGpu) return true;
  return settings.source == kProject || settings.source == kVicp || settings.source == kSlices;
}

std::vector<std::string> check_method(const MethodOptions& method, const RenderSettings& settings,
                                      const Dataset& dataset, const std::string& data_name) {
  const bool is_grid = dataset.is_grid();
  const auto require = [&](bool is_suitable, bool is_option, const char* option, const char* key) {
    if (!is_suitable) refuse(is_option, option, key, is_grid, data_name);
  };
  const bool is_for_grids = settings.source == Source::kMarch || settings.source == Source::kSlices;
  require(!settings.source || is_for_grids == is_grid, method.source.has_value(), "--source", "source");
  require(is_grid || settings.filter == Filter{}, method.filter.has_value(), "--filter", "filter");
  require(is_grid || settings.samples_per_voxel == 0.0, method.samples_per_voxel.has_value(), "--samples-per-voxel",
          "samples_per_voxel");
  require(is_grid || settings.integrator != Integrator::kPre, method.integrator || method.classification,
          method.classification ? "--classification pre" : "--integrator pre", "integrator 'pre'");

  require(!is_grid || settings.integrator != Integrator::kCylindrical, method.integrator.has_value(),
          "--integrator cylindrical", "integrator 'cylindrical'");

  const Source source = settings.source.value_or(is_grid ? Source::kMarch : Source::kWalk);
  UnusedOptions unused;
  check_backend(method, draws_by_gl(method, settings, array_of(dataset).association), source, unused);
  check_tables(method.preintegration, settings, unused);
  check_slices(method, settings, source, unused);
  check_samples(method, settings, source, unused);
  check_projection(method, source, unused);
  check_rays(method, settings, source, unused);
  return unused.lines;
}

}  // namespace tetravox::tool
