#pragma once

/// Curves of colour and absorption, refined into linear pieces.

#include "tetravox/transfer_function.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace tetravox::optics {

/// Largest difference, in any channel, between a refined curve and the curve itself.
inline constexpr double kColorTolerance = 1.0 / 512;
inline constexpr double kOpacityTolerance = 1.0 / 2048;

/// A curve in pieces: `eval(piece, u)` for u in [0, 1]. Values ascend along a piece and from piece to piece; a
/// piece is smooth, and where one ends elsewhere than the next begins there is a step.
struct Curve {
  std::size_t piece_count = 0;
  std::function<ControlPoint(std::size_t piece, double u)> eval;
  double absorption_tolerance = kOpacityTolerance;
};

/// Control points whose linear interpolation is within the tolerances of the curve. Bisects where a quarter, the
/// middle or three quarters of a piece is further off; at most 2^12 parts a piece.
std::vector<ControlPoint> refine(const Curve& curve);

}  // namespace tetravox::optics
