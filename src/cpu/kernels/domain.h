#pragma once

/// Functions of several variables, and colour from another array than opacity, as the kernels want them.

#include "src/optics/antiderivative_table.h"
#include "src/optics/steepness_table.h"

#include <cstdint>

namespace tetravox::cpu {

inline constexpr int kMostVariables = 3;

/// Where a variable comes from, and where it lies in the table: position = (stored scalar - first) *
/// entries_per_scalar.
struct DomainAxis {
  enum class Source {
    kScalar,
    kGradient,  ///< stored scalar: the magnitude of stored scalars a local length
    kOther      ///< of another array: FrameMesh::others, MarchBrick::others
  };
  Source source = Source::kScalar;
  float first = 0.0f, entries_per_scalar = 1.0f;
  std::int32_t last = 1;  ///< entries less 1
  /// Largest change of density, for one unit of stored scalar; where there are `colors`, of these.
  float steepness = 0.0f;
};

/// Where `colors` is set, extinction is that of `IntegratorTables::control_points` at the scalar, and the colour that
/// of `colors` at the second axis; otherwise both are those of `entries`.
struct DomainFunction {
  int count = 0;  ///< of axes
  DomainAxis axes[kMostVariables];
  int gradient_axis = -1;          ///< -1: none
  const float* entries = nullptr;  ///< [..][4] extinction a world length, red, green, blue; first axis fastest
  /// [..], one more than entries along each axis: how many absorb of those below (summed-area table; Crow 1984).
  const std::int32_t* occupied = nullptr;
  const optics::ControlPointTable* colors = nullptr;
  const optics::SteepnessTable* extinctions = nullptr;  ///< with `colors`: of the extinction
  float haze = 0.0f;                                    ///< extinction that counts as none
  float allowed_rate = 0.0f;  ///< error in colour for one unit of world length that pieces may have
  float most_pieces = 12.0f;  ///< that what is bent is cut into
};

}  // namespace tetravox::cpu
