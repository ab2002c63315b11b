#pragma once

/// Bodies drawn from all standard cameras and held against closed forms.

#include "tests/analytic/closed_form.h"
#include "tests/common/body.h"
#include "tests/common/draw.h"

namespace tetravox::analytic {

/// Every ray to its end, and so many samples that `post` is as good as it gets.
inline RenderSettings make_careful_settings(Integrator integrator) {
  RenderSettings settings = tests::make_settings(integrator, 61, 43);
  settings.samples = 256;
  settings.use_early_ray_termination = false;
  return settings;
}

/// For constant media, which are exact but for rounding; that grows with the number of samples.
inline Tolerance constant_tolerance(Integrator integrator) {
  return integrator == Integrator::kPost ? Tolerance{5e-5, 5e-5} : Tolerance{1e-5, 1e-5};
}

/// For fields that vary: `partial` is exact, `antiderivative` errs in colour by a few times its tolerance, the others
/// by their samples: `sampled`.
inline Tolerance varying_tolerance(Integrator integrator, double sampled) {
  switch (integrator) {
    case Integrator::kPartial:
      return {2e-5, 2e-5};
    case Integrator::kAntiderivative:
      return {2e-3, 2e-4};
    default:
      return {sampled, sampled};
  }
}

/// Draws `body` from all standard cameras and holds each picture against `expected`.
inline void expect_shown(const tests::Body& body, const OpticalFunction& function, const RenderSettings& settings,
                         const std::function<Rgba(const Ray&)>& expected, const Tolerance& tolerance) {
  for (const auto& [name, camera] : standard_cameras())
    EXPECT_TRUE(shows(body.draw(function, camera, settings), camera, expected, tolerance)) << name;
}

}  // namespace tetravox::analytic
