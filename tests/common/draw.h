#pragma once

/// Drawing in one line, for tests.

#include "tetravox/render.h"

#include <ostream>

namespace tetravox {

/// How test parameters are written.
inline void PrintTo(CellType type, std::ostream* out) { *out << cell_type_name(static_cast<std::uint8_t>(type)); }
inline void PrintTo(Integrator integrator, std::ostream* out) { *out << name_of(integrator); }

}  // namespace tetravox

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
inline Image draw(const GridData& grid, const OpticalFunction& function, const Camera& camera,
                  const RenderSettings& settings) {
  return render(prepare_grid(grid), function, camera, settings);
}

/// One picture with its statistics.
template <class Prepared>
Image render_with(const Prepared& prepared, const OpticalFunction& function, const Camera& camera,
                  const RenderSettings& settings, RenderStatistics& statistics) {
  Renderer renderer(prepared);
  renderer.set_transfer_function(function);
  return renderer.render(camera, settings, &statistics);
}

inline constexpr Integrator kExactIntegrators[] = {Integrator::kAntiderivative, Integrator::kPartial};
inline constexpr Integrator kAllIntegrators[] = {Integrator::kAntiderivative, Integrator::kPartial, Integrator::kPost};
/// Grids know one more.
inline constexpr Integrator kGridIntegrators[] = {Integrator::kAntiderivative, Integrator::kPartial, Integrator::kPost,
                                                  Integrator::kPre};

}  // namespace tetravox::tests
