#pragma once

/// Functions of several variables, colours by another array, and requests for arrays in scene files.
///
/// Include it only where a scene file is parsed: nlohmann's JSON compiles slowly.

#include "src/optics/json_reader.h"
#include "tetravox/scene.h"

#include <string>

namespace tetravox::scene {

/// Each reads one member of a scene file's object. @throws Error (kBadFile) that names the place.
MultidimensionalFunction read_multidimensional(const optics::JsonPlace& place);
ColorBy read_color_by(const optics::JsonPlace& place);

/// What these read back to equal values.
nlohmann::ordered_json write_multidimensional(const MultidimensionalFunction& function);
nlohmann::ordered_json write_color_by(const ColorBy& color_by);

/// The members "array", "association" and "component" of an object that may have more.
ArrayRequest read_array_request(const optics::JsonPlace& place);
void write_array_request(const ArrayRequest& request, nlohmann::ordered_json& json);

/// A path, not empty.
std::string read_file_name(const optics::JsonPlace& place);

}  // namespace tetravox::scene
