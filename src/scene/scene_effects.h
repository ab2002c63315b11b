#pragma once

/// Light, iso-surfaces and clipping in scene files.
///
/// Include it only where a scene file is parsed: nlohmann's JSON compiles slowly.

#include "src/optics/json_reader.h"
#include "tetravox/scene.h"

namespace tetravox::scene {

/// Each reads one member of a scene file's object. @throws Error (kBadFile) that names the place.
Lighting read_lighting(const optics::JsonPlace& place);
std::vector<Isosurface> read_surfaces(const optics::JsonPlace& place);
Clipping read_clipping(const optics::JsonPlace& place);

/// What these read back to equal values.
nlohmann::ordered_json write_lighting(const Lighting& lighting);
nlohmann::ordered_json write_surfaces(const std::vector<Isosurface>& surfaces);
nlohmann::ordered_json write_clipping(const Clipping& clipping);

/// Whether a lighting says anything but the default.
bool is_default(const Lighting& lighting);

}  // namespace tetravox::scene
