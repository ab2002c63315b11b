#include "tests/reference/view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace tetravox::reference {

Image pick_pixels(const Image& image, const View& view) {
  Image picked{view.drawn_width(), view.drawn_height(), {}};
  picked.pixels.resize(4 * static_cast<std::size_t>(picked.width) * picked.height);
  for (int j = 0; j < picked.height; ++j)
    for (int i = 0; i < picked.width; ++i)
      std::copy_n(image.pixel(view.first_x + i * view.stride, view.first_y + j * view.stride), 4, picked.pixel(i, j));
  return picked;
}

Screen::Screen(const View& seen) : view(seen) {
  is_perspective = !view.camera.parallel_scale.has_value();
  half_height = view.camera.parallel_scale.value_or(std::tan(0.5 * view.camera.view_angle * std::numbers::pi / 180.0));
  half_width = half_height * view.width / view.height;
}

double Screen::x(int i) const {
  const double centre = view.first_x + static_cast<double>(i) * view.stride + 0.5 + 1.3e-7;
  return half_width * (2.0 * centre / view.width - 1.0);
}

double Screen::y(int j) const {
  const double centre = view.first_y + static_cast<double>(j) * view.stride + 0.5 + 0.7e-7;
  return half_height * (1.0 - 2.0 * centre / view.height);
}

Ray Screen::ray(int i, int j) const {
  if (is_perspective) return {{0, 0, 0}, {x(i), y(j), 1.0}};
  return {{x(i), y(j), 0}, {0, 0, 1}};
}

CameraAxes::CameraAxes(const Camera& camera) {
  forward = unit(camera.focal_point - camera.position);
  right = unit(cross(forward, camera.view_up));
  up = cross(right, forward);
}

}  // namespace tetravox::reference
