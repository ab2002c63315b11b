#pragma once

/// The exact picture, by brute force in double precision: every ray against every tetrahedron it may meet.
///
/// Shares no code with the renderer: own split (tetrahedra.h), own optics (segment.h), own camera (view.h).

#include "tests/reference/tetrahedra.h"
#include "tests/reference/view.h"
#include "tetravox/image.h"
#include "tetravox/transfer_function.h"

namespace tetravox::reference {

/// The pixels of `view`, premultiplied, with errors below 1e-6. Cells must not overlap. Uses all cores.
Image draw(const Tetrahedra& tetrahedra, const OpticalFunction& function, const View& view);

}  // namespace tetravox::reference
