#include "apps/tetravox/options_effects.h"

#include "apps/tetravox/option_adding.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tetravox::tool {
namespace {

/// "headlight", "directional:x,y,z", "point:x,y,z", each with ":r,g,b" and "*intensity" behind it.
Light parse_light(const std::string& option, const std::string& text) {
  Light light;
  std::string rest = text;
  if (const std::size_t star = rest.find('*'); star != std::string::npos) {
    light.intensity = parse_positive_number(option, rest.substr(star + 1));
    rest.erase(star);
  }
  const std::vector<std::string> parts = split(rest, ':');
  const std::size_t kind = parse_choice(option, parts[0], {"headlight", "directional", "point"});
  light.kind = kind == 0 ? LightKind::kHeadlight : kind == 1 ? LightKind::kDirectional : LightKind::kPoint;
  const std::size_t color = kind == 0 ? 1 : 2;
  if (kind > 0 && parts.size() < 2)
    throw UsageError(option + ": '" + text + "' says no " + (kind == 1 ? "direction" : "place") + ": give " + parts[0] +
                     ":x,y,z");
  if (parts.size() > color + 1)
    throw UsageError(option + ": '" + text + "' has too many parts: KIND:x,y,z:r,g,b*intensity is all there is");
  if (kind == 1) light.direction = parse_vector(option, parts[1]);
  if (kind == 2) light.position = parse_vector(option, parts[1]);
  if (parts.size() > color) light.color = parse_color(option, parts[color]);
  return light;
}

std::vector<Light> parse_lights(const std::string& option, const std::string& text) {
  if (text == "none") return {};
  std::vector<Light> lights;
  for (const std::string& part : split(text, ';')) lights.push_back(parse_light(option, part));
  return lights;
}

/// A name of surroundings; "none" is empty.
std::string parse_environment(const std::string& option, const std::string& text) {
  if (text.empty()) throw UsageError(option + ": the text is empty");
  return text == "none" ? std::string() : text;
}

Material parse_material(const std::string& option, const std::string& text) {
  const std::vector<double> n = parse_numbers(option, text, 4, "ambient,diffuse,specular,shininess");
  return {n[0], n[1], n[2], n[3]};
}

/// "VALUE", "VALUE:r,g,b", "VALUE:r,g,b:opacity" or "VALUE::opacity".
SurfaceOption parse_surface(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() > 3) throw UsageError(option + ": '" + text + "' is not VALUE, VALUE:r,g,b or VALUE:r,g,b:opacity");
  SurfaceOption surface;
  surface.value = parse_number(option, parts[0]);
  if (parts.size() > 1 && !parts[1].empty()) surface.color = parse_color(option, parts[1]);
  if (parts.size() > 2) surface.opacity = parse_number(option, parts[2]);
  if (!(surface.opacity >= 0.0 && surface.opacity <= 1.0))
    throw UsageError(option + ": '" + parts[2] + "' is no opacity from 0 to 1");
  return surface;
}

ClipShape parse_plane(const std::string& option, const std::string& text) {
  const std::vector<double> n = parse_numbers(option, text, 6, "a point of the plane and its normal, x,y,z,nx,ny,nz");
  return {ClipPlane{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}, true};
}

ClipShape parse_box(const std::string& option, const std::string& text) {
  const std::vector<double> n = parse_numbers(option, text, 6, "x0,x1,y0,y1,z0,z1");
  return {ClipBox{{{{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}}}}, true};
}

ClipShape parse_sphere(const std::string& option, const std::string& text) {
  const std::vector<double> n = parse_numbers(option, text, 4, "centre and radius, x,y,z,r");
  return {ClipSphere{{n[0], n[1], n[2]}, n[3]}, true};
}

/// "FILE" or "FILE:VALUE"; a colon is part of the name where no number follows it.
ClipShape parse_volume(const std::string& option, const std::string& text) {
  ClipVolume volume{text, "", 0.5};
  const std::size_t colon = text.rfind(':');
  const bool is_builtin = text.starts_with("builtin:") && colon == 7;
  if (colon != std::string::npos && !is_builtin) {
    const std::string number = text.substr(colon + 1);
    if (!number.empty() && number.find_first_not_of("0123456789.+-eE") == std::string::npos) {
      volume.value = parse_number(option, number);
      volume.file = text.substr(0, colon);
    }
  }
  if (volume.file.empty()) throw UsageError(option + ": '" + text + "' names no file");
  return {volume, true};
}

/// A setter that adds what `parse` makes of the text to a list; "none" empties it.
template <class T, class Parse>
Setter store_in(std::optional<std::vector<T>>& list, Parse parse) {
  return [&list, parse](const std::string& option, const std::string& text) {
    if (!list || text == "none") list.emplace();
    if (text != "none") list->push_back(parse(option, text));
  };
}

/// A parser of a shape that may have "outside:" before it.
template <class Parse>
auto with_side(Parse parse) {
  return [parse](const std::string& option, const std::string& text) {
    constexpr const char* kOutside = "outside:";
    const bool is_outside = text.starts_with(kOutside);
    ClipShape shape = parse(option, is_outside ? text.substr(8) : text);
    shape.keeps_inside = !is_outside;
    try {
      validate_clipping({{shape}, false});
    } catch (const Error& error) {
      throw UsageError(option + ": " + error.what());
    }
    return shape;
  };
}

}  // namespace

bool EffectOptions::wants_light() const {
  return use_headlight || material || gradient || gradient_threshold || is_two_sided || shadows || ambient_occlusion ||
         (surfaces && !surfaces->empty());
}

void add_light(CLI::App& app, EffectOptions& effects) {
  begin_group(app, "Light");
  add_flag(app, "--shade", effects.use_headlight, "Light from the eye; other options of light and surfaces imply it");
  add(app, "--lights", "LIGHTS",
      "headlight, directional:x,y,z (the way it shines), point:x,y,z, or none; several with ';' between; :r,g,b adds a "
      "colour, *k an intensity",
      store(effects.lights, parse_lights));
  add(app, "--environment", "FILE",
      "Light from surroundings: an equirectangular PNG or EXR, six faces (a directory, or sky_*.png), builtin:NAME "
      "(tetravox list environments), or none",
      store(effects.environment, parse_environment));
  add(app, "--environment-intensity", "K", "Factor of their light (default: 1)",
      store(effects.environment_intensity, parse_number));
  add(app, "--environment-rotation", "DEGREES", "Turn them about their up, counter-clockwise from above (default: 0)",
      store(effects.environment_rotation, parse_number));
  add(app, "--environment-up", "X,Y,Z", "World direction that is up in them (default: 0,0,1)",
      store(effects.environment_up, parse_vector));
  add(app, "--material", "A,D,S,N", "Ambient, diffuse, specular, shininess (default: 0.3,0.7,0.3,32)",
      store(effects.material, parse_material));
  add(app, "--gradient", "NAME", "Where normals come from (tetravox list methods)",
      store(effects.gradient, named(gradient_method_from_name)));
  add(app, "--gradient-threshold", "X",
      "Gradient, in value ranges a diagonal, at which shading has half its strength (default: 2)",
      store(effects.gradient_threshold, parse_number));
  add(app, "--two-sided", "on|off", "Light both sides alike (default: on)", store(effects.is_two_sided, parse_switch));
  add(app, "--shadows", "NAME", "none (default), volume, exact or half-angle: the data shadow themselves",
      store(effects.shadows, named(shadow_kind_from_name)));
  add(app, "--shadow-resolution", "N", "Lattice points a side, 8 to 512 (default: 128)",
      store(effects.shadow_resolution, integer(8, 512)));
  add(app, "--translucency", "W",
      "Shadows half-angle: part of the light that is scattered forward, 0 to 1 (default: 0)",
      store(effects.translucency, parse_number));
  add(app, "--translucency-angle", "DEGREES", "Half the angle of the cone that it is scattered into (default: 20)",
      store(effects.translucency_angle, parse_number));
  add(app, "--ambient-occlusion", "N", "Directions, up to 1024; 64 are smooth (default: 0, none)",
      store(effects.ambient_occlusion, integer(0, 1024)));
}

void add_shapes(CLI::App& app, EffectOptions& effects) {
  begin_group(app, "Surfaces");
  add_repeatable(app, "--isosurface", "VALUE[:R,G,B[:OPACITY]]",
                 "Surface where the field has a value; may be given again (default: the function's colour, opaque); "
                 "none: no surfaces",
                 store_in(effects.surfaces, parse_surface));
  add(app, "--isosurface-back-color", "R,G,B", "Seen from where the field is higher",
      store(effects.surface_back_color, parse_color));
  add_flag(app, "--one-sided", effects.are_surfaces_one_sided, "Surfaces are invisible from where the field is higher");
  add(app, "--volume", "on|off", "Draw the volume, too (default: on)", store(effects.shows_volume, parse_switch));

  begin_group(app, "Clipping (each may be given again; outside: before it keeps what is outside; none: no shapes)");
  std::optional<std::vector<ClipShape>>& shapes = effects.clip_shapes;
  add_repeatable(app, "--clip-plane", "X,Y,Z,NX,NY,NZ", "Keep the side that the normal points to",
                 store_in(shapes, with_side(parse_plane)));
  add_repeatable(app, "--clip-box,--crop", "X0,X1,Y0,Y1,Z0,Z1", "Keep a box", store_in(shapes, with_side(parse_box)));
  add_repeatable(app, "--clip-sphere", "X,Y,Z,R", "Keep a sphere", store_in(shapes, with_side(parse_sphere)));
  add_repeatable(app, "--clip-volume", "FILE[:VALUE]", "Keep where another grid is at least VALUE (default: 0.5)",
                 store_in(shapes, with_side(parse_volume)));
  add(app, "--clip-combine", "intersection|union", "Keep where all shapes agree, or any (default: intersection)",
      [&effects](const std::string& option, const std::string& text) {
        effects.use_union = parse_choice(option, text, {"intersection", "union"}) == 1;
      });

  begin_group(app, "Opacity");
  add(app, "--opacity-weight", "NAME", "Thin out what changes little: none (default), scalar-difference, gradient",
      store(effects.weight, named(opacity_weight_from_name)));
  add(app, "--opacity-weight-scale", "X", "How fast it comes up, above 0 (default: 0.1)",
      store(effects.weight_scale, parse_positive_number));
}

}  // namespace tetravox::tool
