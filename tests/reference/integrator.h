#pragma once

/// The exact picture, by brute force in double precision: every ray against every tetrahedron it may meet.
///
/// Shares no code with the renderer: own split (tetrahedra.h), own optics (segment.h), own camera. It follows
/// docs/conventions.md: pixel centres, row 0 at the top, vertical view angle, rays from the eye (perspective) or from
/// the plane through the camera's position (orthographic).

#include "tests/reference/tetrahedra.h"
#include "tetravox/camera.h"
#include "tetravox/image.h"
#include "tetravox/transfer_function.h"

namespace tetravox::reference {

/// Which pixels of which picture: (first_x + i * stride, first_y + j * stride) of a width x height picture.
struct View {
  Camera camera;
  int width = 64;
  int height = 64;
  int first_x = 0;
  int first_y = 0;
  int stride = 1;  ///< 1: every pixel

  int drawn_width() const { return (width - first_x + stride - 1) / stride; }
  int drawn_height() const { return (height - first_y + stride - 1) / stride; }
};

/// The pixels of `view`, premultiplied, with errors below 1e-6. Cells must not overlap. Uses all cores.
///
/// Rays are moved by a ten-millionth of a pixel off the centres, so that none runs exactly inside a face that two cells
/// share.
Image draw(const Tetrahedra& tetrahedra, const OpticalFunction& function, const View& view);

/// The pixels of `image` that `view` names.
Image pick_pixels(const Image& image, const View& view);

}  // namespace tetravox::reference
