#pragma once

/// Where segments lie in the tables of `table3d`, `polynomial` and `cylindrical`.
///
/// A segment is (scalar front, scalar back, length). The tables run over s in [0, 1], which is the range of the data:
/// were it less, a segment that leaves it would have to be cut. What is stored of colour and opacity is divided by the
/// *opacity bound*, the opacity that the length would have at the largest extinction. That quotient lies in [0, 1], so
/// that it can be stored in fixed point; it is smooth and has a limit for short segments (mean density / largest
/// extinction), so that these are right to first order, and those of no length transparent.
///
/// The functions `eval_*` are in float, and in the order in which the kernels and shaders do the same.

#include "src/optics/antiderivative_table.h"
#include "tetravox/preintegration.h"
#include "tetravox/progress.h"
#include "tetravox/transfer_function.h"

namespace tetravox::optics {

struct SegmentDomain {
  float first = 0.0f;               ///< stored scalar at s = 0
  float per_scalar = 1.0f;          ///< s = clamp((stored - first) * per_scalar, 0, 1)
  float longest = 1.0f;             ///< world length of the longest segment; longer ones are taken as that
  float largest_extinction = 0.0f;  ///< of the function over the domain, per world length
};

/// Premultiplied.
struct SegmentColor {
  float red = 0.0f, green = 0.0f, blue = 0.0f, opacity = 0.0f;
};

/// What tables are made from.
struct PreintegrationSource {
  const OpticalFunction& function;
  ScalarMap map;
  ValueRange range;        ///< of the data, values
  double longest = 1.0;    ///< world length of the longest segment, > 0
  Progress progress = {};  ///< of making a table: @throws Error (kCancelled) where it is told to stop
};

/// The values that s = 0 and s = 1 stand for: the range, widened a little where it is a single value.
ValueRange find_table_range(const PreintegrationSource& source);

SegmentDomain make_segment_domain(const PreintegrationSource& source);

/// s in [0, 1] of a stored scalar.
float eval_scalar_place(const SegmentDomain& domain, float stored);

/// (1 - exp(-x)) / x for x >= 0.
float eval_absorbed_ratio(float depth);

/// The opacity bound of a length: 1 - exp(-largest_extinction * min(length, longest)), as x * eval_absorbed_ratio(x).
float eval_opacity_bound(const SegmentDomain& domain, float length);

/// Where a length lies along a table's axis, in [0, 1], with share = min(length / longest, 1):
/// uniform: share; logarithmic: log2(1 + kLogarithmicRange * share) / kOctaves.
/// So the logarithmic scale is linear up to about longest / kLogarithmicRange, and has 0.
float eval_length_place(LengthSpacing spacing, float share);
inline constexpr float kLogarithmicRange = 4095.0f, kOctaves = 12.0f;

/// The inverse, in double: share of a place.
double share_of_length_place(LengthSpacing spacing, double place);

}  // namespace tetravox::optics
