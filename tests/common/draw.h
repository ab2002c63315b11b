#pragma once

/// Drawing in one line, for tests.

#include "tetravox/render.h"

namespace tetravox::tests {

inline RenderSettings make_settings(Integrator integrator, int width, int height) {
  RenderSettings settings;
  settings.integrator = integrator;
  settings.width = width;
  settings.height = height;
  return settings;
}

inline Image draw(const MeshData& mesh, const OpticalFunction& function, const Camera& camera,
                  const RenderSettings& settings) {
  return render(prepare_mesh(mesh), function, camera, settings);
}

/// One picture with its statistics.
inline Image render_with(const PreparedMesh& mesh, const OpticalFunction& function, const Camera& camera,
                         const RenderSettings& settings, RenderStatistics& statistics) {
  Renderer renderer(mesh);
  renderer.set_transfer_function(function);
  return renderer.render(camera, settings, &statistics);
}

inline constexpr Integrator kExactIntegrators[] = {Integrator::kAntiderivative, Integrator::kPartial};
inline constexpr Integrator kAllIntegrators[] = {Integrator::kAntiderivative, Integrator::kPartial, Integrator::kPost};

}  // namespace tetravox::tests
