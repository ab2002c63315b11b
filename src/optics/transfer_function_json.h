#pragma once

/// The scene file's object for a transfer function, as text and back.

#include "src/optics/json_reader.h"
#include "tetravox/transfer_function.h"

namespace tetravox::optics {

/// Reads { "points": [ { "value", "color", "extinction" or "opacity" } ... ], "unit_distance": d }.
/// @throws Error (kBadFile) that names the place.
TransferFunction read_scene_function(const JsonPlace& place);

/// The same object, from which `read_scene_function` reads an equal function.
nlohmann::ordered_json write_scene_function(const TransferFunction& function);

}  // namespace tetravox::optics
