#pragma once

/// Emission and absorption along one segment on which the scalar is linear, in double precision, by quadrature.

#include "tetravox/transfer_function.h"

namespace tetravox::reference {

/// What a ray has gathered, front to back.
struct RayIntegral {
  Color color{};             ///< premultiplied
  double optical_depth = 0;  ///< opacity is 1 - exp(-optical_depth)
};

/// Adds a segment behind what `ray` holds. The function is split at its control points; on each piece extinction and
/// colour are linear, the optical depth is exact and the emission is a Gauss-Legendre sum with an error below 1e-12.
void append_segment(const OpticalFunction& function, double scalar_front, double scalar_back, double length,
                    RayIntegral& ray);

}  // namespace tetravox::reference
