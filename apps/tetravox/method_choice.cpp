#include "apps/tetravox/method_choice.h"

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

/// Adds a line for each option of tables that the integrator has no use for.
void check_tables(const PreintegrationOptions& tables, Integrator integrator, std::vector<std::string>& lines) {
  const auto is_one_of = [&](std::initializer_list<Integrator> users) {
    return std::find(users.begin(), users.end(), integrator) != users.end();
  };
  const auto check = [&](bool is_given, const std::string& option, std::initializer_list<Integrator> users) {
    if (!is_given || is_one_of(users)) return;
    std::string names;
    for (const Integrator user : users) names += (names.empty() ? "" : ", ") + name_of(user);
    lines.push_back(option + " changes nothing: it is for --integrator " + names + ", and this picture is drawn by " +
                    name_of(integrator));
  };
  constexpr Integrator kTable = Integrator::kTable3d, kPolynomial = Integrator::kPolynomial,
                       kCylindrical = Integrator::kCylindrical;
  check(tables.scalars.has_value(), "--preintegration-size", {kTable, kPolynomial});
  check(tables.length_spacing.has_value(), "--preintegration-lengths", {kTable});
  check(tables.opacity.has_value(), "--preintegration-opacity", {kPolynomial});
  check(tables.planes.has_value(), "--preintegration-planes", {kCylindrical});
  check(tables.tile.has_value(), "--preintegration-tile", {kCylindrical});
  check(tables.steps.has_value(), "--preintegration-steps", {kTable, kPolynomial, kCylindrical});
  check(tables.bits.has_value(), "--preintegration-bits", {kTable, kPolynomial, kCylindrical});
  check(tables.device.has_value(), "--preintegration-device", {kTable, kPolynomial, kCylindrical});
  check(tables.use_incremental.has_value(), "--preintegration-incremental", {kTable, kPolynomial});
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

std::vector<std::string> check_method(const MethodOptions& method, const RenderSettings& settings, bool is_grid,
                                      const std::string& data_name) {
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

  std::vector<std::string> lines;
  if (!method.use_gl && (method.entry_order || method.gl_device))
    lines.push_back(std::string(method.entry_order ? "--entry-order" : "--gl-device") +
                    " changes nothing: it is for --backend gl");
  check_tables(method.preintegration, settings.integrator, lines);
  if ((method.slices || method.slices_per_voxel || method.slabs) && settings.source != Source::kSlices)
    lines.push_back(std::string(method.slices  ? "--slices"
                                : method.slabs ? "--slabs"
                                               : "--slices-per-voxel") +
                    " changes nothing: it is for --source slices");
  const std::string integrator = name_of(settings.integrator);
  if (method.samples && settings.integrator != Integrator::kPost)
    lines.push_back("--samples changes nothing: it is for --integrator post, and this picture is drawn by " +
                    integrator);
  const bool is_projected = settings.source == Source::kProject, is_vicp = settings.source == Source::kVicp;
  const auto note_unused = [&](bool is_given, const char* option, const char* source) {
    if (is_given) lines.push_back(std::string(option) + " changes nothing: it is for --source " + source);
  };
  note_unused(method.sort && !is_projected && !is_vicp, "--sort", "project and vicp");
  note_unused(method.decomposition && !is_projected, "--decomposition", "project");
  note_unused(method.use_pixel_correction && !is_projected, "--pixel-correction", "project");
  note_unused(method.transfer && !is_vicp, "--mesh-transfer", "vicp");
  // Segments of a mesh are its cells, and only `antiderivative` looks at the tolerance inside; a grid's follow it.
  const bool has_fixed_segments = !is_grid || settings.samples_per_voxel > 0.0;
  if (method.tolerance && settings.integrator != Integrator::kAntiderivative && has_fixed_segments)
    lines.push_back("--tolerance changes nothing: the integrator " + integrator +
                    (is_grid ? " with --samples-per-voxel takes segments as they are" : " takes each cell as it is"));
  return lines;
}

}  // namespace tetravox::tool
