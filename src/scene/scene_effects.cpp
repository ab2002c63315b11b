#include "src/scene/scene_effects.h"

#include "src/scene/scene_multidimensional.h"
#include "tetravox/error.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

namespace tetravox::scene {
namespace {

using optics::at_place;
using optics::JsonPlace;
using Json = nlohmann::ordered_json;

void read_number(const JsonPlace& place, const char* key, double& value) {
  if (const auto member = place.find(key)) value = member->number();
}

Light read_light(const JsonPlace& place) {
  Light light;
  const JsonPlace kind = place.at("kind");
  light.kind = at_place(kind, [&] { return light_kind_from_name(kind.string()); });
  switch (light.kind) {
    case LightKind::kHeadlight:
      place.require_keys({"kind", "color", "intensity"});
      break;
    case LightKind::kDirectional:
      place.require_keys({"kind", "direction", "color", "intensity"});
      place.at("direction").numbers(light.direction.data(), 3);
      break;
    case LightKind::kPoint:
      place.require_keys({"kind", "position", "color", "intensity"});
      place.at("position").numbers(light.position.data(), 3);
      break;
  }
  if (const auto color = place.find("color")) color->numbers(light.color.data(), 3);
  read_number(place, "intensity", light.intensity);
  return light;
}

Json write_light(const Light& light) {
  Json json;
  json["kind"] = name_of(light.kind);
  if (light.kind == LightKind::kDirectional) json["direction"] = light.direction;
  if (light.kind == LightKind::kPoint) json["position"] = light.position;
  json["color"] = light.color;
  json["intensity"] = light.intensity;
  return json;
}

void read_material(const JsonPlace& place, Material& material) {
  place.require_keys({"ambient", "diffuse", "specular", "shininess"});
  read_number(place, "ambient", material.ambient);
  read_number(place, "diffuse", material.diffuse);
  read_number(place, "specular", material.specular);
  read_number(place, "shininess", material.shininess);
}

EnvironmentLight read_environment_light(const JsonPlace& place) {
  place.require_keys({"file", "intensity", "rotation", "up"});
  EnvironmentLight light;
  light.file = read_file_name(place.at("file"));
  read_number(place, "intensity", light.intensity);
  read_number(place, "rotation", light.rotation);
  if (const auto up = place.find("up")) up->numbers(light.up.data(), 3);
  return light;
}

Json write_environment_light(const EnvironmentLight& light) {
  return {{"file", light.file}, {"intensity", light.intensity}, {"rotation", light.rotation}, {"up", light.up}};
}

/// Any number that the seed can be: more than `JsonPlace::integer` takes.
std::uint64_t read_seed(const JsonPlace& place) {
  if (!place.value().is_number_unsigned()) place.fail("expected a whole number from 0 to 18446744073709551615");
  return place.value().get<std::uint64_t>();
}

bool read_keep(const JsonPlace& place) {
  const auto keep = place.find("keep");
  if (!keep || keep->string() == "inside") return true;
  if (keep->string() != "outside") keep->fail("expected \"inside\" or \"outside\"");
  return false;
}

ClipShape read_clip_shape(const JsonPlace& place) {
  place.require_keys({"plane", "box", "sphere", "volume", "keep"});
  ClipShape shape;
  int count = 0;
  if (const auto plane = place.find("plane")) {
    plane->require_keys({"origin", "normal"});
    ClipPlane made;
    plane->at("origin").numbers(made.origin.data(), 3);
    plane->at("normal").numbers(made.normal.data(), 3);
    shape.shape = made;
    ++count;
  }
  if (const auto box = place.find("box")) {
    ClipBox made;
    if (box->size() != 3) box->fail("expected three pairs of numbers, along x, y and z");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double bounds[2];
      box->at(axis).numbers(bounds, 2);
      made.bounds[axis] = {bounds[0], bounds[1]};
    }
    shape.shape = made;
    ++count;
  }
  if (const auto sphere = place.find("sphere")) {
    sphere->require_keys({"center", "radius"});
    ClipSphere made;
    sphere->at("center").numbers(made.center.data(), 3);
    made.radius = sphere->at("radius").number();
    shape.shape = made;
    ++count;
  }
  if (const auto volume = place.find("volume")) {
    volume->require_keys({"file", "array", "value"});
    ClipVolume made;
    made.file = read_file_name(volume->at("file"));
    if (const auto array = volume->find("array")) made.array = array->string();
    read_number(*volume, "value", made.value);
    shape.shape = made;
    ++count;
  }
  if (count != 1) place.fail("give one of 'plane', 'box', 'sphere' and 'volume'");
  shape.keeps_inside = read_keep(place);
  return shape;
}

Json write_clip_shape(const ClipShape& shape) {
  Json json;
  if (const auto* plane = std::get_if<ClipPlane>(&shape.shape)) {
    json["plane"]["origin"] = plane->origin;
    json["plane"]["normal"] = plane->normal;
  } else if (const auto* box = std::get_if<ClipBox>(&shape.shape)) {
    for (const ValueRange& range : box->bounds) json["box"].push_back({range.min, range.max});
  } else if (const auto* sphere = std::get_if<ClipSphere>(&shape.shape)) {
    json["sphere"]["center"] = sphere->center;
    json["sphere"]["radius"] = sphere->radius;
  } else if (const auto* volume = std::get_if<ClipVolume>(&shape.shape)) {
    json["volume"]["file"] = volume->file;
    if (!volume->array.empty()) json["volume"]["array"] = volume->array;
    json["volume"]["value"] = volume->value;
  }
  json["keep"] = shape.keeps_inside ? "inside" : "outside";
  return json;
}

}  // namespace

Lighting read_lighting(const JsonPlace& place) {
  place.require_keys({"lights", "environment", "material", "gradient", "gradient_threshold", "two_sided", "shadows",
                      "shadow_resolution", "translucency", "translucency_angle", "ambient_occlusion",
                      "occlusion_seed"});
  Lighting lighting;
  if (const auto lights = place.find("lights"))
    for (std::size_t i = 0; i < lights->size(); ++i) lighting.lights.push_back(read_light(lights->at(i)));
  if (const auto environment = place.find("environment")) lighting.environment = read_environment_light(*environment);
  if (const auto material = place.find("material")) read_material(*material, lighting.material);
  if (const auto gradient = place.find("gradient"))
    lighting.gradient = at_place(*gradient, [&] { return gradient_method_from_name(gradient->string()); });
  read_number(place, "gradient_threshold", lighting.gradient_threshold);
  if (const auto two_sided = place.find("two_sided")) lighting.is_two_sided = two_sided->boolean();
  if (const auto shadows = place.find("shadows"))
    lighting.shadows = at_place(*shadows, [&] { return shadow_kind_from_name(shadows->string()); });
  if (const auto resolution = place.find("shadow_resolution"))
    lighting.shadow_resolution = static_cast<int>(resolution->integer(8, 512));
  read_number(place, "translucency", lighting.translucency);
  read_number(place, "translucency_angle", lighting.translucency_angle);
  if (const auto occlusion = place.find("ambient_occlusion"))
    lighting.ambient_occlusion = static_cast<int>(occlusion->integer(0, 1024));
  if (const auto seed = place.find("occlusion_seed")) lighting.occlusion_seed = read_seed(*seed);
  at_place(place, [&] { validate_lighting(lighting); });
  return lighting;
}

bool is_default(const Lighting& lighting) { return write_lighting(lighting) == write_lighting({}); }

Json write_lighting(const Lighting& lighting) {
  Json json;
  json["lights"] = Json::array();
  for (const Light& light : lighting.lights) json["lights"].push_back(write_light(light));
  if (lighting.environment) json["environment"] = write_environment_light(*lighting.environment);
  const Material& material = lighting.material;
  json["material"] = {{"ambient", material.ambient},
                      {"diffuse", material.diffuse},
                      {"specular", material.specular},
                      {"shininess", material.shininess}};
  json["gradient"] = name_of(lighting.gradient);
  json["gradient_threshold"] = lighting.gradient_threshold;
  json["two_sided"] = lighting.is_two_sided;
  json["shadows"] = name_of(lighting.shadows);
  json["shadow_resolution"] = lighting.shadow_resolution;
  if (lighting.shadows == ShadowKind::kHalfAngle) {
    json["translucency"] = lighting.translucency;
    json["translucency_angle"] = lighting.translucency_angle;
  }
  json["ambient_occlusion"] = lighting.ambient_occlusion;
  json["occlusion_seed"] = lighting.occlusion_seed;
  return json;
}

std::vector<Isosurface> read_surfaces(const JsonPlace& place) {
  std::vector<Isosurface> surfaces;
  for (std::size_t i = 0; i < place.size(); ++i) {
    const JsonPlace at = place.at(i);
    at.require_keys({"value", "color", "front_color", "back_color", "opacity", "two_sided"});
    Isosurface& surface = surfaces.emplace_back();
    surface.value = at.at("value").number();
    const auto color = at.find("color"), front = at.find("front_color"), back = at.find("back_color");
    if (color && (front || back)) at.fail("give 'color' for both sides, or 'front_color' and 'back_color'");
    if (color) {
      color->numbers(surface.front_color.data(), 3);
      surface.back_color = surface.front_color;
    }
    if (front) front->numbers(surface.front_color.data(), 3);
    if (back) back->numbers(surface.back_color.data(), 3);
    read_number(at, "opacity", surface.opacity);
    if (const auto two_sided = at.find("two_sided")) surface.is_two_sided = two_sided->boolean();
  }
  at_place(place, [&] { validate_isosurfaces(surfaces); });
  return surfaces;
}

Json write_surfaces(const std::vector<Isosurface>& surfaces) {
  Json json = Json::array();
  for (const Isosurface& surface : surfaces)
    json.push_back({{"value", surface.value},
                    {"front_color", surface.front_color},
                    {"back_color", surface.back_color},
                    {"opacity", surface.opacity},
                    {"two_sided", surface.is_two_sided}});
  return json;
}

Clipping read_clipping(const JsonPlace& place) {
  place.require_keys({"combine", "shapes"});
  Clipping clipping;
  if (const auto combine = place.find("combine")) {
    if (combine->string() != "intersection" && combine->string() != "union")
      combine->fail("expected \"intersection\" or \"union\"");
    clipping.use_union = combine->string() == "union";
  }
  const JsonPlace shapes = place.at("shapes");
  for (std::size_t i = 0; i < shapes.size(); ++i) clipping.shapes.push_back(read_clip_shape(shapes.at(i)));
  at_place(place, [&] { validate_clipping(clipping); });
  return clipping;
}

Json write_clipping(const Clipping& clipping) {
  Json json;
  json["combine"] = clipping.use_union ? "union" : "intersection";
  json["shapes"] = Json::array();
  for (const ClipShape& shape : clipping.shapes) json["shapes"].push_back(write_clip_shape(shape));
  return json;
}

}  // namespace tetravox::scene
