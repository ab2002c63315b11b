#include "apps/tetravox/json_report.h"

#include "tetravox/slicing.h"

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetravox::tool {
namespace {

using Json = nlohmann::ordered_json;

/// Largest resident set of this process, or of its children that have ended, bytes.
std::uint64_t peak_resident_memory(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

/// A number, or null where it is not finite: JSON knows no other.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json range(const ValueRange& values) { return Json::array({number(values.min), number(values.max)}); }

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json array_json(const ArrayInfo& array) {
  Json json;
  json["name"] = array.name;
  json["association"] = array.association == Association::kPoint ? "point" : "cell";
  json["components"] = array.components;
  json["type"] = array.type;
  json["range"] = range(array.magnitude_range);
  for (const ValueRange& values : array.component_ranges) json["component_ranges"].push_back(range(values));
  json["nan_count"] = array.nan_count;
  return json;
}

Json prepare_json(const PrepareReport& report) {
  return {{"input_cells", report.input_cells},
          {"tetrahedra", report.tetrahedra},
          {"merged_points", report.merged_points},
          {"degenerate", report.degenerate},
          {"missing_value_cells", report.missing_value_cells},
          {"duplicated", report.duplicated},
          {"overlapping_faces", report.overlapping_faces},
          {"boundary_faces", report.boundary_faces}};
}

Json prepare_json(const GridStatistics& grid) {
  return {
      {"values", grid.values}, {"type", grid.type}, {"missing_values", grid.missing_values}, {"bricks", grid.bricks}};
}

Json projection_json(const ProjectionSettings& settings, const ProjectionStatistics& statistics) {
  return {{"sort", name_of(settings.sort)},
          {"decomposition", name_of(settings.decomposition)},
          {"pixel_correction", settings.use_pixel_correction},
          {"transfer", name_of(settings.transfer)},
          {"seconds",
           {{"sort", statistics.sort_seconds},
            {"decompose", statistics.decompose_seconds},
            {"draw", statistics.draw_seconds}}},
          {"cells", statistics.cells},
          {"cells_at_eye", statistics.cells_at_eye},
          {"cycles", statistics.cycles},
          {"cyclic_cells", statistics.cyclic_cells},
          {"broken_relations", statistics.broken_relations}};
}

/// "i", "j", "k" of the axes whose points are not evenly spaced.
Json uneven_axes(const GridShape& shape) {
  Json axes = Json::array();
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!shape.coordinates[axis].empty()) axes.push_back(std::string(1, "ijk"[axis]));
  return axes;
}

Json grid_json(const GridShape& shape) {
  return {{"dimensions", shape.dimensions},
          {"origin", shape.origin},
          {"spacing", shape.spacing},
          {"direction", shape.direction},
          {"uneven_axes", uneven_axes(shape)}};
}

/// Of all but the first, or of the only one.
double median_seconds(std::vector<double> seconds) {
  if (seconds.empty()) return 0.0;
  if (seconds.size() > 1) seconds.erase(seconds.begin());
  std::sort(seconds.begin(), seconds.end());
  const std::size_t middle = seconds.size() / 2;
  return seconds.size() % 2 == 1 ? seconds[middle] : 0.5 * (seconds[middle - 1] + seconds[middle]);
}

Json check_json(const OrderReport& report) {
  return {{"face_pairs", report.face_pairs},
          {"face_violations", report.face_violations},
          {"rays", report.rays},
          {"segments", report.segments},
          {"wrong_segments", report.wrong_segments},
          {"wrong_rays", report.wrong_rays},
          {"thin_segments", report.thin_segments},
          {"intersections", report.intersections},
          {"intersecting_rays", report.intersecting_rays}};
}

}  // namespace

double median_frame_seconds(const PictureStatistics& statistics) { return median_seconds(statistics.frame_seconds); }
double median_sort_seconds(const OrderStatistics& statistics) { return median_seconds(statistics.sort_seconds); }

std::string format_statistics(const PictureStatistics& statistics) {
  Json json;
  Json& seconds = json["seconds"];
  seconds["read"] = statistics.read_seconds;
  seconds["prepare"] = statistics.prepare_seconds;
  seconds["choose"] = statistics.choose_seconds;
  seconds["transfer_function"] = statistics.transfer_function_seconds;
  seconds["first_frame"] = statistics.frame_seconds.empty() ? 0.0 : statistics.frame_seconds.front();
  seconds["frame"] = median_frame_seconds(statistics);
  seconds["write"] = statistics.write_seconds;
  seconds["total"] = statistics.total_seconds;
  json["frames"] = statistics.frame_seconds.size();
  json["segments"] = statistics.render.segments;
  json["rays"] = statistics.render.rays;
  json["stopped_rays"] = statistics.render.stopped_rays;
  Json& bytes = json["bytes"];
  bytes["input"] = statistics.input_bytes;
  const std::optional<GridStatistics>& grid = statistics.body.grid;
  if (grid) {
    bytes["grid"] = grid->value_bytes + statistics.body.bytes;
    bytes["summaries"] = statistics.body.bytes;
  } else {
    bytes["mesh"] = statistics.body.bytes;
  }
  bytes["frame"] = statistics.frame_bytes;
  bytes["peak_rss"] = peak_resident_memory(RUSAGE_SELF);
  bytes["reader_peak_rss"] = peak_resident_memory(RUSAGE_CHILDREN);
  json["threads"] = statistics.render.threads;
  json["isa"] = statistics.render.instruction_set;
  json["backend"] = statistics.render.backend;
  if (!statistics.render.device.empty()) json["device"] = statistics.render.device;
  json["kind"] = grid ? "grid" : "mesh";
  if (grid) json["dimensions"] = grid->dimensions;
  const Source source = statistics.settings.source.value_or(grid ? Source::kMarch : Source::kWalk);
  if (source == Source::kProject || source == Source::kVicp)
    json["projection"] = projection_json(statistics.settings.projection, statistics.render.projection);
  json["source"] = name_of(SourceChoice{source, statistics.settings.slicing.kind});
  if (source == Source::kSlices) json["slices"] = statistics.render.slices;
  json["integrator"] = statistics.render.integrator;
  if (grid) json["filter"] = name_of(statistics.settings.filter);
  json["resolution"] = {statistics.settings.width, statistics.settings.height};
  json["array"] = statistics.array;
  json["prepare"] = grid ? prepare_json(*grid) : prepare_json(statistics.body.mesh);
  json["version"] = TETRAVOX_VERSION;
  return dump(json);
}

std::string format_statistics(const OrderStatistics& statistics) {
  const SortStatistics& sort = statistics.sort;
  Json json;
  Json& seconds = json["seconds"];
  seconds["read"] = statistics.read_seconds;
  seconds["prepare"] = statistics.prepare_seconds;
  seconds["recover"] = statistics.recover_seconds;
  seconds["first_sort"] = statistics.sort_seconds.empty() ? 0.0 : statistics.sort_seconds.front();
  seconds["sort"] = median_sort_seconds(statistics);
  seconds["relations"] = sort.relation_seconds;
  seconds["gaps"] = sort.boundary_seconds;
  json["sorts"] = statistics.sort_seconds.size();
  json["method"] = name_of(statistics.method);
  json["cells"] = sort.cells;
  json["cells_per_second"] = static_cast<double>(sort.cells) / std::max(1e-9, median_sort_seconds(statistics));
  json["gap_relations"] = sort.boundary_relations;
  json["cycles"] = sort.cycles;
  json["cyclic_cells"] = sort.cyclic_cells;
  json["broken_relations"] = sort.broken_relations;
  if (statistics.check) json["check"] = check_json(*statistics.check);
  json["bytes"] = {{"sorter", statistics.sorter_bytes}, {"peak_rss", peak_resident_memory(RUSAGE_SELF)}};
  json["threads"] = sort.threads;
  json["prepare"] = prepare_json(statistics.mesh);
  json["version"] = TETRAVOX_VERSION;
  return dump(json);
}

std::string format_info_json(const DatasetInfo& info, std::optional<std::size_t> default_array,
                             const std::optional<MemoryPlan>& memory) {
  Json json;
  json["source"] = info.source;
  json["format"] = info.format;
  json["kind"] = info.grid ? "grid" : "mesh";
  if (info.grid) json["grid"] = grid_json(*info.grid);
  json["points"] = info.point_count;
  json["cells"] = info.cell_count;
  json["blocks"] = info.block_count;
  json["cells_by_type"] = Json::object();
  for (const auto& [type, count] : info.cells_by_type)
    json["cells_by_type"][cell_type_name(static_cast<std::uint8_t>(type))] = count;
  json["left_out"] = {{"lower_dimension", info.left_out.lower_dimension},
                      {"ghost", info.left_out.ghost},
                      {"blanked", info.left_out.blanked},
                      {"unsupported", info.left_out.unsupported}};
  json["bounds"] = Json::array({range(info.bounds[0]), range(info.bounds[1]), range(info.bounds[2])});
  json["times"] = info.times;
  json["time_index"] = info.time_index;
  json["arrays"] = Json::array();
  for (const ArrayInfo& array : info.arrays) json["arrays"].push_back(array_json(array));
  json["default_array"] = default_array ? Json(info.arrays[*default_array].name) : Json();
  if (memory) {
    Json& bytes = json["bytes"];
    if (info.grid) bytes["values"] = memory->values;
    bytes["prepare_peak"] = memory->prepare;
    bytes[info.grid ? "summaries" : "mesh"] = memory->resident;
    bytes["render"] = memory->render;
    bytes["available"] = memory->available;
  }
  json["notes"] = info.notes;
  return dump(json);
}

}  // namespace tetravox::tool
