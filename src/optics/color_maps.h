#pragma once

/// The colour maps that have a name.

#include "tetravox/transfer_function.h"

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace tetravox::optics {

/// Largest opacity of the preset "linear", for a hundredth of the diagonal.
inline constexpr double kLinearOpacity = 0.1;

struct ColorMapEntry {
  const char* name;
  const char* description;
};

/// A colour at t in [0, 1]; linear in between.
struct ColorMapPoint {
  double t = 0.0;
  Color color{};
};

/// All maps, in the order in which they are listed.
std::span<const ColorMapEntry> color_maps();

/// Points of a map, t ascending from 0 to 1; empty for a name that is not in `color_maps`.
std::vector<ColorMapPoint> color_map_points(std::string_view name);

/// Colour of a map at t, clamped to its ends.
Color eval_color_map(std::span<const ColorMapPoint> points, double t);

}  // namespace tetravox::optics
