#pragma once

/// Iso-surfaces inside the volume, composited with it in exact order.

#include "tetravox/transfer_function.h"

#include <vector>

namespace tetravox {

/// The places where the field has one value.
struct Isosurface {
  double value = 0.0;
  Color front_color{0.9, 0.9, 0.9};  ///< seen from where the field is lower than `value`
  Color back_color{0.9, 0.9, 0.9};   ///< seen from where it is higher
  double opacity = 1.0;              ///< in [0, 1]
  bool is_two_sided = true;          ///< otherwise it is invisible from behind
};

/// @throws Error (kInvalidArgument) that names the surface's index and member.
void validate_isosurfaces(const std::vector<Isosurface>& surfaces);

}  // namespace tetravox
