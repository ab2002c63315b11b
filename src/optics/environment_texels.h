#pragma once

/// Where the texels of an environment lie. Directions in its frame: (right, up, ahead).

#include "tetravox/environment.h"

namespace tetravox::optics {

/// A place of a face: (0, 0) is its upper left corner, (1, 1) its lower right one.
struct FacePlace {
  int face = 0;
  double x = 0.0, y = 0.0;
};

/// The unit vector towards a place.
Vector3 direction_of(EnvironmentLayout layout, const FacePlace& place);

/// Solid angle about a place, in any unit that is the same all over the environment.
double spread_of(EnvironmentLayout layout, const FacePlace& place);

}  // namespace tetravox::optics
