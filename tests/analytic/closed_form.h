#pragma once

/// Rays and boxes, to say in closed form what a pixel must hold.

#include "tetravox/camera.h"
#include "tetravox/image.h"
#include "tetravox/transfer_function.h"

#include <gtest/gtest.h>

#include <functional>

namespace tetravox::analytic {

/// A viewing ray from the eye (or the camera's plane): origin + t * direction with |direction| = 1, t >= 0.
struct Ray {
  Vector3 origin{};
  Vector3 direction{};

  Vector3 at(double t) const;
};

/// The ray through the centre of pixel (x, y) of a width x height picture.
Ray make_ray(const Camera& camera, int width, int height, int x, int y);

/// The part of a ray inside a box; empty where `far <= near`.
struct Chord {
  double near = 0.0, far = 0.0;
  double length() const { return far > near ? far - near : 0.0; }
};
Chord intersect_box(const Ray& ray, const Vector3& lower, const Vector3& upper);

/// Premultiplied RGBA.
using Rgba = std::array<double, 4>;

/// Colour behind a homogeneous medium of this optical depth.
Rgba fill(const Color& color, double optical_depth);

/// `front` over `back`, both premultiplied.
Rgba over(const Rgba& front, const Rgba& back);

/// Emission and absorption of any function along a chord by a fine midpoint rule; `extinction_color(t)` gives the two
/// at t in [0, 1]. Error about 1e-7 for functions that are smooth, and it falls with the square of `steps`.
struct Medium {
  double extinction = 0.0;
  Color color{};
};
Rgba integrate(double length, const std::function<Medium(double)>& medium_at, int steps = 2000);

/// Absolute, of premultiplied values.
struct Tolerance {
  double color = 1e-5;
  double opacity = 1e-5;
};

/// Holds where every pixel is what `expected` says, and at least a tenth of the pixels is not empty. Names the worst.
::testing::AssertionResult shows(const Image& image, const Camera& camera,
                                 const std::function<Rgba(const Ray&)>& expected, const Tolerance& tolerance);

/// Three views of something about as large as [-1, 1]^3 at the origin: perspective, orthographic, from inside.
std::vector<std::pair<const char*, Camera>> standard_cameras();

}  // namespace tetravox::analytic
