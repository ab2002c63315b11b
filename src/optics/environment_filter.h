#pragma once

/// An environment as light needs it: gathered over the lobes of diffuse and of specular reflection, by direction
/// (reflection maps; Miller and Hoffman 1984; Heidrich and Seidel 1999).

#include "tetravox/environment.h"

#include <array>
#include <vector>

namespace tetravox::optics {

/// A colour over directions, at the nodes of square lattices on the faces of a cube, bilinear in between. Nodes lie on
/// the edges, too, where faces that meet hold the same colours: the whole is continuous.
///
/// Faces 2 a and 2 a + 1 are those of the positive and the negative axis a of (right, up, ahead). With d the direction
/// divided by |component a|, columns go from -1 to 1 with component (a + 1) mod 3, rows with component (a + 2) mod 3.
struct DirectionTable {
  int size = 0;                ///< nodes a side
  std::vector<float> records;  ///< [6][size][size][4]: red, green, blue, 0
};

/// A uniform environment of radiance 1 is 1 everywhere in all of these.
struct FilteredEnvironment {
  DirectionTable diffuse;       ///< by normal: irradiance / pi
  DirectionTable specular;      ///< by the reflected direction of the view
  std::array<float, 3> mean{};  ///< over all directions
};

/// Filters a valid environment for a shininess N >= 1. The same bytes for any number of threads.
///
/// The specular lobe is cos^N(theta / 2), theta from the reflected direction r: what Blinn's highlight (n.h)^N is of
/// lights around an eye that looks along the normal. It is as wide as Phong's with N / 4 (Fisher and Woo 1994). Away
/// from the normal Blinn's is longer than wide; that no map by r alone can tell, and is left out.
///
/// Both are sums over bins of a size that the lobe decides (see `Glow`), divided by those of a uniform environment. The
/// lobe ends where it is a ten-thousandth of its height.
FilteredEnvironment filter_environment(const Environment& environment, double shininess);

}  // namespace tetravox::optics
