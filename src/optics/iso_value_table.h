#pragma once

/// The control points that a segment meets first, found by its two scalars.
///
/// Espinha and Celes 2005, section 4: a two-dimensional texture over (scalar front, scalar back) holds the first
/// iso-value that a segment meets and the one after. Scalars in the same texel as an iso-value may lie on either side
/// of it; the tie rule decides: what has reached the first iso-value goes on from there.
///
/// How we differ: the interval between control points is kept too, so that what lies in front of the first iso-value is
/// known exactly, steps included; and scalars that have passed both iso-values are told apart.

#include "src/optics/antiderivative_table.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::optics {

/// Texels over the scalars from the first control point to the last, clamped.
struct IsoValueTable {
  static constexpr int kSize = 256;  ///< a side
  float first = 0.0f;                ///< stored scalar at the beginning of texel 0
  float texels_per_scalar = 0.0f;
  /// [kSize back][kSize front][4]: first and next iso-value (stored scalars, infinite where there is none), number of
  /// the interval of `ControlPointTable` in front of the first, nothing. Falling segments are below the diagonal (back
  /// < front); those within one texel are taken as rising.
  std::vector<std::array<float, 4>> texels;
};

IsoValueTable build_iso_value_table(const ControlPointTable& points);

/// The interval in which a ray sets out from `front` towards `back`: the scalar reference of the shaders. A ray that
/// rises from a control point starts in the interval that begins there, one that falls in the one that ends there.
/// Within a texel that has more than two control points it may be wrong: then it is too near to where the ray comes
/// from.
std::int32_t find_front_interval(const IsoValueTable& table, float front, float back);

}  // namespace tetravox::optics
