#pragma once

/// The three-dimensional table in sheared cylindrical coordinates, as tiles of a two-dimensional atlas (Roettger and
/// Ertl 2002).
///
/// With d = s_back - s_front (the shear) and h = length / longest, all segments of no length and no difference lie on
/// the axis d = h = 0. When a tetrahedron is projected, each of its triangles spans a plane that holds a part of this
/// axis, so that planes through the axis are all that is needed: one tile a plane.
///
/// How we differ: a look-up mixes the two planes beside it, since a ray has another one for each segment; where the
/// paper has angle and radius, we have the place on a square around the axis and its size, which lose no texels and
/// need no trigonometry; and the place along the axis goes from end to end of what can occur at a difference, so that
/// no texel lies beyond the scalars that there are:
///   radius v = max(|d|, h)
///   turn   w = d / h where |d| <= h;  2 - h / d where d > h;  -2 + h / -d where -d > h;  0 on the axis. In [-2, 2]
///   along  u = min(s_front, s_back) / (1 - |d|)

#include "src/optics/segment_domain.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::optics {

/// Plane p is at w = -2 + 4 p / (planes - 1); its texel (i, j) is at u = i / (tile - 1), v = j / (tile - 1). Bilinear
/// in a tile, linear from plane to plane.
struct CylindricalAtlas {
  SegmentDomain domain;
  int planes = 0, tile = 0;
  int columns = 0, rows = 0;  ///< of tiles: plane p is in column p % columns, row p / columns
  /// [rows * tile][columns * tile][4]: premultiplied red, green, blue, and opacity, each divided by the opacity bound
  /// of the length; at length 0 the limit, mean density / largest extinction. In [0, 1]. As a texture: x along u. Tiles
  /// need no border: u and v end at texel centres.
  std::vector<float> texels;

  std::uint64_t bytes() const { return texels.size() * sizeof(float); }
};

/// Columns of tiles: an atlas is about as wide as high.
int count_atlas_columns(int planes);

/// Bytes of an atlas of that size.
std::uint64_t cylindrical_atlas_bytes(int planes, int tile);

/// Makes `atlas` anew, on all cores, each texel by `steps` steps of integration.
/// @throws Error (kOutOfMemory) where it does not fit into memory.
void build_cylindrical_atlas(const PreintegrationSource& source, const PreintegrationSettings& settings,
                             CylindricalAtlas& atlas);

/// The look-up of `cylindrical`: the scalar reference of kernel and shader. Stored scalars, world length.
SegmentColor eval_cylindrical_atlas(const CylindricalAtlas& atlas, float scalar_front, float scalar_back, float length);

}  // namespace tetravox::optics
