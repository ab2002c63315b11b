#pragma once

/// Settings of the integrators that look ray integrals up in tables: `table3d`, `polynomial`, `cylindrical`.
///
/// They are the methods of the literature, for comparison; docs/methods/preintegration.md has formulas and errors.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// How the lengths of a three-dimensional table are spaced from 0 to the longest segment.
enum class LengthSpacing {
  kUniform,     ///< Roettger, Kraus, Ertl 2000
  kLogarithmic  ///< fine where segments are short (after Kraus, Qiao, Ebert 2004)
};

/// Opacity of a segment of optical depth x (polynomial).
enum class OpacityModel {
  kExponential,  ///< 1 - exp(-x)
  kLinear        ///< min(1, x), for comparison
};

/// What makes a table.
enum class TableDevice {
  kCpu,  ///< exact means of every step, in double precision
  kGpu   ///< the device that draws, by blended samples as in the papers (OpenGL)
};

/// Of which integrator each is the option stands in brackets.
struct PreintegrationSettings {
  int scalars = 128;  ///< entries along each scalar, in [2, 512] (table3d); in [2, 2048] (polynomial)
  int lengths = 64;   ///< entries along the length, in [2, 512] (table3d)
  LengthSpacing length_spacing = LengthSpacing::kLogarithmic;  ///< (table3d)
  int degree = 2;                                              ///< of the chromaticity, in [0, 4] (polynomial)
  OpacityModel opacity = OpacityModel::kExponential;           ///< (polynomial)
  int planes = 65;  ///< through the axis of the cylinder, in [2, 1024] (cylindrical)
  int tile = 64;    ///< texels along each side of a plane's tile, in [2, 512] (cylindrical)
  int steps = 64;   ///< of integration for each entry, at least, in [1, 4096] (all)
  int bits = 32;    ///< each number is stored in: 8, 12, 16 (fixed point, emulated) or 32 (float) (all)
  TableDevice device = TableDevice::kCpu;  ///< (all)
  bool use_incremental = true;  ///< each entry from its neighbours along a diagonal; else each anew (table3d,
                                ///< polynomial; Lum, Wilson, Ma 2004)

  bool operator==(const PreintegrationSettings&) const = default;
};

inline constexpr int kLargestTableSize = 512;        ///< of `scalars` and `lengths` of table3d, and `tile`
inline constexpr int kLargestDensityMapSize = 2048;  ///< of `scalars` of polynomial
inline constexpr int kLargestPlaneCount = 1024;
inline constexpr int kLargestDegree = 4;
inline constexpr int kMostIntegrationSteps = 4096;

/// @throws Error (kInvalidArgument) for the first setting out of range.
void validate_preintegration(const PreintegrationSettings& settings);

/// Names of enumerators as on the command line and in scene files ("uniform", "logarithmic"; "exponential",
/// "linear"), and back.
std::string name_of(LengthSpacing spacing);
std::string name_of(OpacityModel opacity);
std::string name_of(TableDevice device);  ///< "cpu", "gpu"
/// @throws Error (kInvalidArgument) that lists the names there are.
LengthSpacing length_spacing_from_name(const std::string& name);
OpacityModel opacity_model_from_name(const std::string& name);
TableDevice table_device_from_name(const std::string& name);

}  // namespace tetravox
