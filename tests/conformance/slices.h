#pragma once

/// Pictures by slices, and the same by the CPU.

#include "tests/common/draw.h"
#include "tetravox/render.h"

namespace tetravox::conformance {

inline RenderSettings slices_of(SlicingKind kind, int slices, Integrator integrator = Integrator::kAntiderivative) {
  RenderSettings settings = tests::make_settings(integrator, 48, 36);
  settings.source = Source::kSlices;
  settings.slicing.kind = kind;
  settings.slicing.slices = slices;
  settings.tolerance = 1e-4;
  return settings;
}

inline RenderSettings cpu_settings(RenderSettings settings) {
  settings.source.reset();
  settings.slicing = {};
  if (settings.lighting.shadows == ShadowKind::kHalfAngle) settings.lighting.shadows = ShadowKind::kExact;
  return settings;
}

}  // namespace tetravox::conformance
