#pragma once

/// The default camera, fitted exactly to points.

#include "tetravox/camera.h"

#include <cmath>

namespace tetravox::scene {

/// An oblique perspective view, z up, as near as all points that were added allow, with a margin of 5 %. The direction
/// is chosen by the bounds: across the longer horizontal edge, and from higher above for flat things.
///
/// A point at (a, z), a along an axis of the picture and z along the line of sight, is within the picture when
/// |a - c| <= slope * (z - f) for an eye at (c, f). Both sides are linear, so that the nearest eye is found from
/// two maxima over the points, without iteration.
class CameraFit {
 public:
  /// @throws Error (kInvalidArgument) for bounds that are no finite ranges, or an aspect that is not above 0.
  CameraFit(const std::array<ValueRange, 3>& bounds, double aspect);

  void add_corners();
  void add_point(const Vector3& point);  ///< world units, within the bounds
  /// The view of what was added; of the corners if that was nothing.
  Camera camera();

 private:
  struct Axis {
    double slope = 0.0;
    double upper = -HUGE_VAL, lower = -HUGE_VAL;

    void add(double a, double z);
    double center() const { return 0.5 * (upper - lower); }
    double forward() const { return -(upper + lower) / (2.0 * slope); }
  };

  void add_offset(const Vector3& offset);

  Vector3 center_{}, half_{};
  Vector3 forward_{}, right_{}, up_{};
  Axis horizontal_, vertical_;
  bool is_point_ = false;
};

}  // namespace tetravox::scene
