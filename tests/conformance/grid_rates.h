#pragma once

/// Grids whose values rays read where they lie, and settings of a fixed rate, for conformance tests.

#include "tests/common/draw.h"
#include "tests/common/grid_builder.h"

#include <cmath>

namespace tetravox::conformance {

inline RenderSettings at_rate(double rate, Integrator integrator, double tolerance = 2e-3) {
  RenderSettings settings = tests::make_settings(integrator, 64, 48);
  settings.samples_per_voxel = rate;
  settings.tolerance = tolerance;
  return settings;
}

/// Number types whose values rays read where they lie.
inline constexpr ScalarType kInPlace[] = {ScalarType::kInt8, ScalarType::kUint8, ScalarType::kInt16,
                                          ScalarType::kUint16, ScalarType::kFloat32};

/// The same whole numbers from 0 to 100 in any type, over several bricks that are not whole.
inline GridData make_numbers(ScalarType type) {
  tests::GridOptions options;
  options.dimensions = {23, 19, 17};
  options.type = type;
  const tests::Field field = tests::make_random_field(21, 3.0);
  return make_grid(options, [&](const Vector3& p) { return std::round(100.0 * field(p)); });
}

}  // namespace tetravox::conformance
