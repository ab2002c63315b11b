#pragma once

/// Colour spaces in which colour maps are interpolated, as VTK's vtkColorTransferFunction does.

#include "tetravox/transfer_function.h"

#include <optional>
#include <string>

namespace tetravox::optics {

enum class ColorSpace {
  kRgb,
  kHsv,         ///< hue the direct way
  kHsvWrapped,  ///< hue the shorter way around
  kLab,         ///< CIE L*a*b*, D65
  kDiverging,   ///< Moreland 2009: Msh, through white between two saturated hues that differ
  kStep         ///< an interval has the colour of its upper end
};

/// The space that ParaView calls `name` ("RGB", "HSV", "Lab", "CIELAB", "Lab/CIEDE2000", "Diverging", "Step", ...);
/// nothing for other names.
std::optional<ColorSpace> color_space_from_name(const std::string& name);

/// Colour at `t` in [0, 1] between two colours. Result within [0, 1].
Color mix_colors(ColorSpace space, const Color& a, const Color& b, double t);

}  // namespace tetravox::optics
