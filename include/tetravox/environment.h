#pragma once

/// Surroundings that light the data: a picture of what shines from every direction.
///
/// An `Environment` is such a picture, read by `read_environment` (io.h) or made by a formula. `EnvironmentLight`
/// (lighting.h) says how it lights; `Renderer::set_environment` hands it over.
///
/// Its frame is (right, up, ahead), as somebody sees it who stands in its middle.

#include "tetravox/camera.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

enum class EnvironmentLayout {
  /// Twice as wide as high. The upper row is up, the middle of the picture ahead, right of that is right.
  kEquirectangular,
  /// Six square faces: right, left, up, down, ahead, behind ("px", "nx", "py", "ny", "pz", "nz"), each as seen from
  /// inside; the upper edge of "up" meets "behind", that of "down" meets "ahead" (the orientation of OpenGL's cube
  /// maps).
  kCube
};

inline constexpr int kMostEnvironmentTexels = 1 << 25;
inline constexpr float kLargestRadiance = 1e9f;

struct Environment {
  EnvironmentLayout layout = EnvironmentLayout::kEquirectangular;
  int width = 0, height = 0;    ///< of the picture, or of each face
  std::vector<float> radiance;  ///< RGB in [0, kLargestRadiance]; [height][width][3], or [6][height][width][3]

  int face_count() const { return layout == EnvironmentLayout::kCube ? 6 : 1; }
};

/// @throws Error (kInvalidArgument) that names what is wrong: shape, count, or the texel whose radiance is.
void validate_environment(const Environment& environment);

/// The embedded environment "builtin:NAME", or "NAME". @throws Error (kInvalidArgument) that lists the names there are.
Environment make_builtin_environment(const std::string& name);
/// Names, one-line descriptions.
std::vector<std::pair<std::string, std::string>> builtin_environment_names();

/// Unit vectors of the world: right, up, ahead of an environment whose up is `up` (any length but 0), turned about that
/// by `rotation` degrees, counter-clockwise as seen from above.
///
/// Unturned, right is the x axis made perpendicular to up (the y axis, where up is within 25 degrees of x): with z up
/// the picture's middle lies along y, with y up along -z.
std::array<Vector3, 3> environment_axes(const Vector3& up, double rotation);

}  // namespace tetravox
