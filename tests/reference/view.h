#pragma once

/// Which pixels are drawn, and their rays. Follows docs/conventions.md: pixel centres, row 0 at the top, vertical view
/// angle, rays from the eye (perspective) or from the plane through the camera's position (orthographic).
///
/// Rays are moved by a ten-millionth of a pixel off the centres, so that none runs exactly inside a face that two cells
/// share.

#include "tests/reference/vectors.h"
#include "tetravox/camera.h"
#include "tetravox/image.h"

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

/// The pixels of `image` that `view` names.
Image pick_pixels(const Image& image, const View& view);

/// A ray in camera space (x right, y up, z away from the eye): origin + z * direction, with direction[2] = 1.
struct Ray {
  Vec origin{};
  Vec direction{0, 0, 1};
};

/// The picture's plane: where pixel columns and rows lie in camera space at depth one (perspective) or anywhere.
struct Screen {
  bool is_perspective = true;
  double half_width = 1.0, half_height = 1.0;
  View view;

  explicit Screen(const View& view);

  /// Centre of column i (row j) of the drawn pixels, in camera space.
  double x(int i) const;
  double y(int j) const;
  Ray ray(int i, int j) const;
};

/// Axes of camera space in the world, unit vectors.
struct CameraAxes {
  Vec right{}, up{}, forward{};

  explicit CameraAxes(const Camera& camera);

  Vec camera_from_world(const Vec& v) const { return {dot(v, right), dot(v, up), dot(v, forward)}; }
  Vec world_from_camera(const Vec& v) const { return v[0] * right + v[1] * up + v[2] * forward; }
};

}  // namespace tetravox::reference
