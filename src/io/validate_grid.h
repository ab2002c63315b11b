#pragma once

#include "tetravox/dataset.h"

#include <string>
#include <vector>

namespace tetravox::io {

/// Checks that a lattice keeps the promises of `GridShape`: at least two points along each axis, a finite origin,
/// finite positive spacings, a finite invertible direction, coordinates finite, strictly ascending and as many as there
/// are points.
/// @throws Error that names `file`: kNothingToDraw for a lattice without volume, otherwise kBadFile.
void validate_grid_shape(const GridShape& shape, const std::string& file);

/// Checks a grid's lattice, its components, and that it has the values it promises.
/// @throws Error as above.
void validate_grid(const GridData& grid, const std::string& file);

/// Replaces what makes no sense of an orientation as a file states it, and says so in `notes`: an origin that is not
/// finite becomes 0, a spacing that is zero or not finite 1, a direction that cannot be inverted the identity. Negative
/// spacings turn their axis.
void mend_orientation(GridShape& shape, std::vector<std::string>& notes);

/// Whether the 3 x 3 matrix is finite and, judged by the volume that its columns span relative to their lengths, can be
/// inverted.
bool is_invertible(const std::array<double, 9>& matrix);

}  // namespace tetravox::io
