#pragma once

/// The embedded grids, and what they have in common.

#include "tetravox/dataset.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tetravox::grid {

inline constexpr std::uint32_t kFewestPoints = 2;  ///< along each axis
inline constexpr std::uint32_t kMostPoints = 4096;

/// An embedded grid as people see it.
struct BuiltinGridEntry {
  std::string name;
  std::string description;
  std::uint32_t default_size = 0;
  ScalarType default_type = ScalarType::kFloat32;
  bool has_seed = false;
};
const std::vector<BuiltinGridEntry>& builtin_grids();

struct BuiltinGridRequest {
  std::uint32_t size = 0;  ///< points along each axis, in [kFewestPoints, kMostPoints]
  ScalarType type = ScalarType::kFloat32;
  std::uint64_t seed = 0;
};

/// Makes the grid with this entry's name: its first field in `grid`, the rest in `other_grids`, in the order of its
/// arrays. They have values in [0, 1]; integers are that stretched over all that their type can hold, rounded to the
/// nearest. Messages and the summary call it `source`.
/// @throws Error (kOutOfMemory) before anything is allocated.
Dataset make_builtin_grid(const BuiltinGridEntry& entry, const BuiltinGridRequest& request, const std::string& source);

/// A field on a cube of size^3 points.
struct BuiltinField {
  std::string array_name;
  ValueRange extent;  ///< of each axis, world units: the first and the last point
  /// Calls `write` with each row of slice k in turn, [size] values in [0, 1]. Safe to call from many threads.
  std::function<void(std::size_t k, const std::function<void(std::span<const double> row)>& write)> visit_slice;
};

/// The test signal of Marschner and Lobb (1994), f_M = 6 and alpha = 0.25, on [-1, 1]^3: nearly all of its energy lies
/// just below the Nyquist frequency of 41^3 points.
BuiltinField make_marschner_lobb_field(std::uint32_t size);

/// Probability density of the 3d orbital with m = 0 of a hydrogen atom, two lobes and a ring, as a part of its largest
/// value among the points: (3 z^2 - r^2)^2 exp(-2 r / 3), in Bohr radii.
BuiltinField make_hydrogen_field(std::uint32_t size);

/// The wave function whose square that is, (3 z^2 - r^2) exp(-r / 3): -1 to 1 of its largest magnitude as 0 to 1.
BuiltinField make_hydrogen_wave(std::uint32_t size);

/// A sum of octaves of band-limited noise on [0, 1]^3, each with half the amplitude of the one before, stretched such
/// that the points' values fill [0, 1]. The same on every machine, for any number of threads.
BuiltinField make_turbulence_field(std::uint32_t size, std::uint64_t seed);

/// Coordinate of point i of `size` in `extent`; exact at both ends.
inline double place_in(const ValueRange& extent, std::size_t i, std::uint32_t size) {
  const double t = static_cast<double>(i) / (static_cast<double>(size) - 1.0);
  return extent.min * (1.0 - t) + extent.max * t;
}

}  // namespace tetravox::grid
