#include "src/scene/scene_multidimensional.h"

#include "src/optics/transfer_function_json.h"
#include "tetravox/error.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tetravox::scene {
namespace {

using optics::at_place;
using optics::JsonPlace;
using Json = nlohmann::ordered_json;

constexpr int kLargestComponent = 1'000'000;
constexpr long long kLeastTableResolution = 16, kLargestTableResolution = 1024;
constexpr std::size_t kMostWidgets = 1000;

Variable read_variable(const JsonPlace& place) {
  Variable variable;
  const JsonPlace kind = place.at("kind");
  variable.kind = at_place(kind, [&] { return variable_kind_from_name(kind.string()); });
  if (variable.kind == VariableKind::kArray) {
    place.require_keys({"kind", "array", "association", "component", "range"});
    if (place.at("array").string().empty()) place.at("array").fail("expected the name of an array");
    variable.array = read_array_request(place);
  } else {
    place.require_keys({"kind", "range"});
  }
  if (const auto range = place.find("range")) {
    double ends[2];
    range->numbers(ends, 2);
    variable.range = ValueRange{ends[0], ends[1]};
  }
  return variable;
}

Json write_variable(const Variable& variable) {
  Json json;
  json["kind"] = name_of(variable.kind);
  if (variable.kind == VariableKind::kArray) write_array_request(variable.array, json);
  if (variable.range) json["range"] = {variable.range->min, variable.range->max};
  return json;
}

Widget read_widget(const JsonPlace& place, std::size_t variables) {
  place.require_keys({"shape", "center", "radius", "color", "opacity"});
  Widget widget;
  const JsonPlace shape = place.at("shape");
  widget.shape = at_place(shape, [&] { return widget_shape_from_name(shape.string()); });
  place.at("center").numbers(widget.center.data(), variables);
  place.at("radius").numbers(widget.radius.data(), variables);
  if (const auto color = place.find("color")) color->numbers(widget.color.data(), 3);
  if (const auto opacity = place.find("opacity")) widget.opacity = opacity->number();
  return widget;
}

Json write_widget(const Widget& widget, std::size_t variables) {
  Json json;
  json["shape"] = name_of(widget.shape);
  json["center"] = std::span(widget.center).first(variables);
  json["radius"] = std::span(widget.radius).first(variables);
  json["color"] = widget.color;
  json["opacity"] = widget.opacity;
  return json;
}

}  // namespace

std::string read_file_name(const JsonPlace& place) {
  const std::string& name = place.string();
  if (name.empty() || name.find('\0') != std::string::npos) place.fail("not a file name");
  return name;
}

ArrayRequest read_array_request(const JsonPlace& place) {
  ArrayRequest request;
  if (const auto array = place.find("array")) request.name = array->string();
  if (const auto association = place.find("association")) {
    if (association->string() != "point" && association->string() != "cell")
      association->fail("expected \"point\" or \"cell\"");
    request.association = association->string() == "point" ? Association::kPoint : Association::kCell;
  }
  if (const auto component = place.find("component")) {
    if (component->value().is_string() && component->string() == "magnitude")
      request.component = kMagnitude;
    else if (component->value().is_number())
      request.component = static_cast<int>(component->integer(0, kLargestComponent));
    else
      component->fail("expected 0, 1, 2, ... or \"magnitude\"");
  }
  return request;
}

void write_array_request(const ArrayRequest& request, Json& json) {
  if (!request.name.empty()) json["array"] = request.name;
  if (request.association) json["association"] = *request.association == Association::kPoint ? "point" : "cell";
  if (request.component && *request.component == kMagnitude) json["component"] = "magnitude";
  if (request.component && *request.component != kMagnitude) json["component"] = *request.component;
}

MultidimensionalFunction read_multidimensional(const JsonPlace& place) {
  place.require_keys({"variables", "widgets", "table", "resolution", "unit_distance"});
  MultidimensionalFunction function;
  const JsonPlace variables = place.at("variables");
  if (variables.size() < 2 || variables.size() > 3) variables.fail("expected two or three variables");
  for (std::size_t i = 0; i < variables.size(); ++i) function.variables.push_back(read_variable(variables.at(i)));
  const auto widgets = place.find("widgets"), table = place.find("table");
  if (widgets.has_value() == table.has_value()) place.fail("give either 'widgets' or 'table'");
  if (table) function.table_file = read_file_name(*table);
  if (widgets && (widgets->size() == 0 || widgets->size() > kMostWidgets)) widgets->fail("expected 1 to 1000 widgets");
  for (std::size_t i = 0; widgets && i < widgets->size(); ++i)
    function.widgets.push_back(read_widget(widgets->at(i), variables.size()));
  if (const auto resolution = place.find("resolution"))
    function.resolution = static_cast<int>(resolution->integer(kLeastTableResolution, kLargestTableResolution));
  if (const auto distance = place.find("unit_distance")) function.unit_distance = distance->number();
  at_place(place, [&] { validate_multidimensional(function); });
  return function;
}

Json write_multidimensional(const MultidimensionalFunction& function) {
  Json json;
  json["variables"] = Json::array();
  for (const Variable& variable : function.variables) json["variables"].push_back(write_variable(variable));
  for (const Widget& widget : function.widgets)
    json["widgets"].push_back(write_widget(widget, function.variables.size()));
  if (!function.table_file.empty()) json["table"] = function.table_file;
  json["resolution"] = function.resolution;
  if (function.unit_distance) json["unit_distance"] = *function.unit_distance;
  return json;
}

ColorBy read_color_by(const JsonPlace& place) {
  place.require_keys({"array", "association", "component", "function"});
  const JsonPlace array = place.at("array");
  if (array.string().empty()) array.fail("names no array");
  ColorBy color_by;
  color_by.array = read_array_request(place);
  if (const auto function = place.find("function")) color_by.function = optics::read_scene_function(*function);
  return color_by;
}

Json write_color_by(const ColorBy& color_by) {
  Json json;
  write_array_request(color_by.array, json);
  if (color_by.function) json["function"] = optics::write_scene_function(*color_by.function);
  return json;
}

}  // namespace tetravox::scene

namespace tetravox {

std::vector<ArrayRequest> other_arrays(const Scene& scene) {
  std::vector<ArrayRequest> arrays;
  if (scene.multidimensional)
    for (const Variable& variable : scene.multidimensional->variables)
      if (variable.kind == VariableKind::kArray) arrays.push_back(variable.array);
  if (scene.color_by) arrays.push_back(scene.color_by->array);
  return arrays;
}

}  // namespace tetravox
