#pragma once

/// Reconstruction kernels in one dimension, written down from their papers.

#include "tetravox/grid.h"

#include <cstddef>
#include <vector>

namespace tetravox::reference {

/// Half the width of the kernel in values: 1 (linear), 2 (cubics), N (lanczos). Not for kNearest.
int kernel_radius(const Filter& filter);

/// Weights of the values at floor - radius + 1 ... floor + radius for a place at floor + `fraction`, fraction in [0,
/// 1]. They sum to one: linear; cubic B-spline; Keys' (1981) cubic with a = -1/2, which is Catmull and Rom's (1974);
/// Mitchell and Netravali's (1988) with B = C = 1/3; Lanczos' window on a sinc (Duchon 1979), divided by its sum.
void make_weights(const Filter& filter, double fraction, double* weights);

/// Coefficients of the cubic B-spline that goes through `values` (Unser, Aldroubi, Eden 1991), mirrored about its first
/// and last value, by the solution of the linear equations (c[i-1] + 4 c[i] + c[i+1]) / 6 = value[i].
void solve_bspline(std::vector<double>& values);

}  // namespace tetravox::reference
