#pragma once

/// Emission and absorption along one segment on which the scalar is linear, in double precision, by quadrature.

#include "tetravox/transfer_function.h"

#include <cstddef>

namespace tetravox::reference {

/// What a ray has gathered, front to back.
struct RayIntegral {
  Color color{};             ///< premultiplied
  double optical_depth = 0;  ///< opacity is 1 - exp(-optical_depth)
};

/// Beyond this optical depth (transmittance 2e-22) nothing can be seen.
inline constexpr double kOpaque = 50.0;

/// Number of control points at or below `value`: the function's linear piece that begins at `value` ends at this point.
std::size_t find_piece(const OpticalFunction& function, double value);

/// The function at `value`, taken from the linear piece that ends at control point `upper` (so that steps have two
/// sides).
OpticalPoint eval_piece(const OpticalFunction& function, std::size_t upper, double value);

/// Adds a segment behind what `ray` holds. The function is split at its control points; on each piece extinction and
/// colour are linear, the optical depth is exact and the emission is a Gauss-Legendre sum with an error below 1e-12.
void append_segment(const OpticalFunction& function, double scalar_front, double scalar_back, double length,
                    RayIntegral& ray);

}  // namespace tetravox::reference
