#pragma once

/// The exact picture of a grid, in double precision: every ray cell by cell.
///
/// Shares no code with the renderer: own kernels (kernels.h), own field (grid_field.h), own optics (curve.h), own
/// camera (view.h).

#include "tests/reference/view.h"
#include "tetravox/dataset.h"
#include "tetravox/grid.h"
#include "tetravox/image.h"
#include "tetravox/transfer_function.h"

namespace tetravox::reference {

/// When the function is applied: to the field between the values (what every other integrator stands for), or to the
/// values themselves, extinction and extinction times colour being reconstructed in between.
enum class Classification { kOfField, kOfValues };

struct GridMethod {
  Filter filter;
  Classification classification = Classification::kOfField;
  /// Above 0: the field along a ray counts as linear in each of so many equal pieces of its stay in a cell. 0: exact.
  int pieces_per_cell = 0;
};

/// The pixels of `view`, premultiplied, with errors below 1e-7 where the field is a polynomial along the ray in each
/// cell (all filters but kLanczos), otherwise below 1e-6. A cell with a value that is not finite within the kernel's
/// reach is transparent. The volume is the box of the points; for cell data with filters that take values as points,
/// the box of the cells' middles. Uses all cores.
Image draw(const GridData& grid, const GridMethod& method, const OpticalFunction& function, const View& view);

}  // namespace tetravox::reference
