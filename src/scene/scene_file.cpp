#include "src/optics/transfer_function_json.h"
#include "src/scene/scene_effects.h"
#include "src/scene/scene_multidimensional.h"
#include "tetravox/error.h"
#include "tetravox/scene.h"
#include "tetravox/slicing.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tetravox {
namespace {

using optics::at_place;
using optics::JsonPlace;
using Json = nlohmann::ordered_json;

constexpr int kSceneVersion = 1;
constexpr int kLargestSampleCount = 4096;
constexpr int kLargestComponentCount = 4;
constexpr long long kLargestDimension = 0xFFFFFFFE;
constexpr long long kLargestHeader = 1LL << 53;

void read_time(const JsonPlace& place, TimeRequest& time) {
  place.require_keys({"index", "value"});
  if (const auto index = place.find("index"))
    time.index = static_cast<std::size_t>(index->integer(0, 1'000'000'000'000));
  if (const auto value = place.find("value")) time.value = value->number();
  if (time.index.has_value() == time.value.has_value()) place.fail("give either 'index' or 'value'");
}

/// The keys of `place` that say how the bytes of a RAW file are to be understood.
void read_raw_layout(const JsonPlace& place, RawLayout& raw) {
  if (const auto dimensions = place.find("dimensions")) {
    if (dimensions->size() != 3) dimensions->fail("expected three numbers, points along x, y and z");
    raw.dimensions.emplace();
    for (std::size_t axis = 0; axis < 3; ++axis)
      (*raw.dimensions)[axis] = static_cast<std::uint32_t>(dimensions->at(axis).integer(1, kLargestDimension));
  }
  if (const auto type = place.find("scalar_type"))
    raw.type = at_place(*type, [&] { return scalar_type_from_name(type->string()); });
  if (const auto components = place.find("components"))
    raw.components = static_cast<int>(components->integer(1, kLargestComponentCount));
  if (const auto spacing = place.find("spacing")) {
    raw.spacing.emplace();
    spacing->numbers(raw.spacing->data(), 3);
    for (const double step : *raw.spacing)
      if (!(step > 0.0)) spacing->fail("expected three numbers above 0");
  }
  if (const auto is_big_endian = place.find("big_endian")) raw.is_big_endian = is_big_endian->boolean();
  if (const auto header = place.find("header_bytes"))
    raw.header_bytes = static_cast<std::uint64_t>(header->integer(0, kLargestHeader));
}

SceneData read_data(const JsonPlace& place) {
  place.require_keys({"file", "solution_file", "array", "association", "component", "time", "dimensions", "scalar_type",
                      "components", "spacing", "big_endian", "header_bytes"});
  SceneData data;
  data.file = scene::read_file_name(place.at("file"));
  if (const auto solution = place.find("solution_file")) data.solution_file = scene::read_file_name(*solution);
  data.array = scene::read_array_request(place);
  if (const auto time = place.find("time")) read_time(*time, data.time);
  read_raw_layout(place, data.raw);
  return data;
}

Camera read_camera(const JsonPlace& place) {
  place.require_keys({"position", "focal_point", "view_up", "view_angle", "parallel_scale"});
  Camera camera;
  place.at("position").numbers(camera.position.data(), 3);
  place.at("focal_point").numbers(camera.focal_point.data(), 3);
  if (const auto view_up = place.find("view_up")) view_up->numbers(camera.view_up.data(), 3);
  const auto view_angle = place.find("view_angle"), parallel_scale = place.find("parallel_scale");
  if (view_angle && parallel_scale)
    place.fail("give 'view_angle' (perspective) or 'parallel_scale' (orthographic), not both");
  if (view_angle) camera.view_angle = view_angle->number();
  if (parallel_scale) camera.parallel_scale = parallel_scale->number();
  at_place(place, [&] { validate_camera(camera); });
  return camera;
}

void read_image(const JsonPlace& place, Scene& scene) {
  place.require_keys({"resolution", "background"});
  if (const auto resolution = place.find("resolution")) {
    if (resolution->size() != 2) resolution->fail("expected two numbers, width and height");
    scene.settings.width = static_cast<int>(resolution->at(std::size_t{0}).integer(1, kLargestResolution));
    scene.settings.height = static_cast<int>(resolution->at(std::size_t{1}).integer(1, kLargestResolution));
  }
  if (const auto background = place.find("background")) {
    background->numbers(scene.background.data(), 3);
    for (const double channel : scene.background)
      if (!(channel >= 0.0 && channel <= 1.0)) background->fail("colours are three numbers in [0, 1]");
  }
}

void read_preintegration(const JsonPlace& place, PreintegrationSettings& tables) {
  place.require_keys(
      {"scalars", "lengths", "length_spacing", "opacity", "planes", "tile", "steps", "bits", "device", "incremental"});
  const auto read_integer = [&](const char* key, int& number) {
    if (const auto at = place.find(key)) number = static_cast<int>(at->integer(1, kLargestSampleCount));
  };
  read_integer("scalars", tables.scalars);
  read_integer("lengths", tables.lengths);
  read_integer("planes", tables.planes);
  read_integer("tile", tables.tile);
  read_integer("steps", tables.steps);
  read_integer("bits", tables.bits);
  if (const auto spacing = place.find("length_spacing"))
    tables.length_spacing = at_place(*spacing, [&] { return length_spacing_from_name(spacing->string()); });
  if (const auto opacity = place.find("opacity"))
    tables.opacity = at_place(*opacity, [&] { return opacity_model_from_name(opacity->string()); });
  if (const auto device = place.find("device"))
    tables.device = at_place(*device, [&] { return table_device_from_name(device->string()); });
  if (const auto use = place.find("incremental")) tables.use_incremental = use->boolean();
  at_place(place, [&] { validate_preintegration(tables); });
}

ProjectionSettings read_projection(const JsonPlace& place) {
  place.require_keys({"sort", "decomposition", "pixel_correction", "transfer"});
  ProjectionSettings settings;
  const auto read = [&](const char* key, auto& value, const auto& from_name) {
    if (const auto found = place.find(key)) value = at_place(*found, [&] { return from_name(found->string()); });
  };
  read("sort", settings.sort, cell_sort_from_name);
  read("decomposition", settings.decomposition, decomposition_from_name);
  if (const auto use = place.find("pixel_correction")) settings.use_pixel_correction = use->boolean();
  read("transfer", settings.transfer, mesh_transfer_from_name);
  return settings;
}

void read_render(const JsonPlace& place, RenderSettings& settings) {
  place.require_keys({"source", "projection", "integrator", "preintegration", "filter", "tolerance", "samples",
                      "samples_per_voxel", "slices", "slices_per_voxel", "slabs", "opacity_weight",
                      "opacity_weight_scale", "early_ray_termination"});
  if (const auto source = place.find("source")) {
    const SourceChoice choice = at_place(*source, [&] { return source_choice_from_name(source->string()); });
    settings.source = choice.source;
    settings.slicing.kind = choice.slicing;
  }
  if (const auto slices = place.find("slices"))
    settings.slicing.slices = static_cast<int>(slices->integer(1, kMostSlices));
  if (const auto slabs = place.find("slabs"))
    settings.slicing.slabs = at_place(*slabs, [&] { return slab_shape_from_name(slabs->string()); });
  if (const auto rate = place.find("slices_per_voxel")) {
    settings.slicing.slices_per_voxel = rate->number();
    at_place(*rate, [&] { validate_slicing(settings.slicing); });
  }
  if (const auto projection = place.find("projection")) settings.projection = read_projection(*projection);
  if (const auto integrator = place.find("integrator"))
    at_place(*integrator, [&] { parse_integrator(integrator->string(), settings); });
  if (const auto tables = place.find("preintegration")) read_preintegration(*tables, settings.preintegration);
  if (const auto filter = place.find("filter"))
    settings.filter = at_place(*filter, [&] { return filter_from_name(filter->string()); });
  if (const auto tolerance = place.find("tolerance")) {
    settings.tolerance = tolerance->number();
    if (!(settings.tolerance >= kSmallestTolerance && settings.tolerance <= 1.0))
      tolerance->fail("expected a number in [1e-7, 1]");
  }
  if (const auto samples = place.find("samples"))
    settings.samples = static_cast<int>(samples->integer(1, kLargestSampleCount));
  if (const auto rate = place.find("samples_per_voxel")) {
    settings.samples_per_voxel = rate->number();
    if (!(settings.samples_per_voxel >= kLowestRate && settings.samples_per_voxel <= kHighestRate))
      rate->fail("expected a number from 0.001 to 64; leave it out for as many as the tolerance asks");
  }
  if (const auto weight = place.find("opacity_weight"))
    settings.opacity_weight = at_place(*weight, [&] { return opacity_weight_from_name(weight->string()); });
  if (const auto scale = place.find("opacity_weight_scale")) {
    settings.opacity_weight_scale = scale->number();
    if (!(settings.opacity_weight_scale > 0.0)) scale->fail("expected a number above 0");
  }
  if (const auto use = place.find("early_ray_termination")) settings.use_early_ray_termination = use->boolean();
}

void require_version(const JsonPlace& root) {
  const auto version = root.find("tetravox");
  if (!version) root.fail("not a scene: the key 'tetravox' (the version, 1) is missing");
  if (!version->value().is_number_integer() || version->value() != kSceneVersion)
    version->fail("this program reads scenes of version 1, not " + optics::printable(version->value().dump()));
}

/// Text with one line for each member of an object and each element of a list; vectors and control points stay in one.
std::string layout(const Json& json, int depth) {
  const auto is_short = [](const Json& value) {
    for (const Json& element : value)
      if (element.is_structured() && (value.is_array() || !element.is_array())) return false;
    return value.is_array() || value.contains("value") || value.empty();
  };
  if (!json.is_structured() || is_short(json)) return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string margin(2 * (static_cast<std::size_t>(depth) + 1), ' ');
  std::string text(1, json.is_array() ? '[' : '{');
  bool is_first = true;
  for (const auto& member : json.items()) {
    text += (is_first ? "\n" : ",\n") + margin;
    if (json.is_object()) text += Json(member.key()).dump() + ": ";
    text += layout(member.value(), depth + 1);
    is_first = false;
  }
  return text + "\n" + margin.substr(2) + (json.is_array() ? ']' : '}');
}

Json write_data(const SceneData& data) {
  Json json;
  json["file"] = data.file;
  if (!data.solution_file.empty()) json["solution_file"] = data.solution_file;
  scene::write_array_request(data.array, json);
  if (data.time.index) json["time"]["index"] = *data.time.index;
  if (data.time.value) json["time"]["value"] = *data.time.value;
  const RawLayout& raw = data.raw;
  if (raw.dimensions) json["dimensions"] = *raw.dimensions;
  if (raw.type) json["scalar_type"] = scalar_type_name(*raw.type);
  if (raw.components) json["components"] = *raw.components;
  if (raw.spacing) json["spacing"] = *raw.spacing;
  if (raw.is_big_endian) json["big_endian"] = *raw.is_big_endian;
  if (raw.header_bytes > 0) json["header_bytes"] = raw.header_bytes;
  return json;
}

Json write_camera(const Camera& camera) {
  Json json;
  json["position"] = camera.position;
  json["focal_point"] = camera.focal_point;
  json["view_up"] = camera.view_up;
  if (camera.parallel_scale)
    json["parallel_scale"] = *camera.parallel_scale;
  else
    json["view_angle"] = camera.view_angle;
  return json;
}

/// What is not as by default; the degree is part of the integrator's name.
Json write_preintegration(const PreintegrationSettings& tables) {
  const PreintegrationSettings usual;
  Json json;
  if (tables.scalars != usual.scalars) json["scalars"] = tables.scalars;
  if (tables.lengths != usual.lengths) json["lengths"] = tables.lengths;
  if (tables.length_spacing != usual.length_spacing) json["length_spacing"] = name_of(tables.length_spacing);
  if (tables.opacity != usual.opacity) json["opacity"] = name_of(tables.opacity);
  if (tables.planes != usual.planes) json["planes"] = tables.planes;
  if (tables.tile != usual.tile) json["tile"] = tables.tile;
  if (tables.steps != usual.steps) json["steps"] = tables.steps;
  if (tables.bits != usual.bits) json["bits"] = tables.bits;
  if (tables.device != usual.device) json["device"] = name_of(tables.device);
  if (tables.use_incremental != usual.use_incremental) json["incremental"] = tables.use_incremental;
  return json;
}

Json write_projection(const ProjectionSettings& settings) {
  Json json;
  json["sort"] = name_of(settings.sort);
  json["decomposition"] = name_of(settings.decomposition);
  json["pixel_correction"] = settings.use_pixel_correction;
  json["transfer"] = name_of(settings.transfer);
  return json;
}

Json write_render(const RenderSettings& settings) {
  Json json;
  if (settings.source) json["source"] = name_of(SourceChoice{*settings.source, settings.slicing.kind});
  if (settings.projection != ProjectionSettings{}) json["projection"] = write_projection(settings.projection);
  json["integrator"] = format_integrator(settings);
  const Json tables = write_preintegration(settings.preintegration);
  if (!tables.empty()) json["preintegration"] = tables;
  if (settings.filter != Filter{}) json["filter"] = name_of(settings.filter);
  json["tolerance"] = settings.tolerance;
  json["samples"] = settings.samples;
  if (settings.samples_per_voxel > 0.0) json["samples_per_voxel"] = settings.samples_per_voxel;
  if (settings.slicing.slabs != SlabShape::kCurved) json["slabs"] = name_of(settings.slicing.slabs);
  if (settings.slicing.slices > 0) json["slices"] = settings.slicing.slices;
  if (settings.slicing.slices_per_voxel != SlicingSettings{}.slices_per_voxel)
    json["slices_per_voxel"] = settings.slicing.slices_per_voxel;
  if (settings.opacity_weight != OpacityWeight::kNone) {
    json["opacity_weight"] = name_of(settings.opacity_weight);
    json["opacity_weight_scale"] = settings.opacity_weight_scale;
  }
  json["early_ray_termination"] = settings.use_early_ray_termination;
  return json;
}

}  // namespace

Scene parse_scene(const std::string& text, const std::string& source_name) {
  const nlohmann::json json = optics::parse_json(text, source_name);
  const JsonPlace root(json, source_name);
  require_version(root);
  root.require_keys({"tetravox", "data", "transfer_function", "multidimensional", "color_by", "surfaces", "clipping",
                     "lighting", "camera", "image", "render"});
  Scene scene;
  scene.data = read_data(root.at("data"));
  if (const auto function = root.find("transfer_function"))
    scene.transfer_function = optics::read_scene_function(*function);
  if (const auto function = root.find("multidimensional"))
    scene.multidimensional = scene::read_multidimensional(*function);
  if (const auto color_by = root.find("color_by")) scene.color_by = scene::read_color_by(*color_by);
  if (scene.multidimensional && (scene.transfer_function || scene.color_by))
    root.fail("'multidimensional' has colours and opacities of its own: leave out 'transfer_function' and 'color_by'");
  if (const auto surfaces = root.find("surfaces")) scene.settings.surfaces = scene::read_surfaces(*surfaces);
  if (const auto clipping = root.find("clipping")) scene.settings.clipping = scene::read_clipping(*clipping);
  if (const auto lighting = root.find("lighting")) scene.settings.lighting = scene::read_lighting(*lighting);
  if (const auto camera = root.find("camera")) scene.camera = read_camera(*camera);
  if (const auto image = root.find("image")) read_image(*image, scene);
  if (const auto render = root.find("render")) read_render(*render, scene.settings);
  return scene;
}

std::string format_scene(const Scene& scene) {
  Json json;
  json["tetravox"] = kSceneVersion;
  json["data"] = write_data(scene.data);
  if (scene.transfer_function) json["transfer_function"] = optics::write_scene_function(*scene.transfer_function);
  if (scene.multidimensional) json["multidimensional"] = scene::write_multidimensional(*scene.multidimensional);
  if (scene.color_by) json["color_by"] = scene::write_color_by(*scene.color_by);
  const RenderSettings& settings = scene.settings;
  if (!settings.surfaces.empty()) json["surfaces"] = scene::write_surfaces(settings.surfaces);
  if (!settings.clipping.shapes.empty()) json["clipping"] = scene::write_clipping(settings.clipping);
  if (!scene::is_default(settings.lighting)) json["lighting"] = scene::write_lighting(settings.lighting);
  if (scene.camera) json["camera"] = write_camera(*scene.camera);
  json["image"]["resolution"] = {scene.settings.width, scene.settings.height};
  json["image"]["background"] = scene.background;
  json["render"] = write_render(scene.settings);
  return layout(json, 0) + "\n";
}

}  // namespace tetravox
