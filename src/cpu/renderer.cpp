#include "src/cpu/frame_renderers.h"
#include "src/cpu/kernels/kernels.h"
#include "tetravox/render.h"

#include <string>
#include <vector>

namespace tetravox {

Renderer::Renderer(const PreparedMesh& mesh) : Renderer(cpu::make_mesh_renderer(mesh)) {}
Renderer::Renderer(const PreparedGrid& grid) : Renderer(cpu::make_grid_renderer(grid)) {}

Image render(const PreparedMesh& mesh, const OpticalFunction& function, const Camera& camera,
             const RenderSettings& settings) {
  Renderer renderer(mesh);
  renderer.set_transfer_function(function);
  return renderer.render(camera, settings);
}

Image render(const PreparedGrid& grid, const OpticalFunction& function, const Camera& camera,
             const RenderSettings& settings) {
  Renderer renderer(grid);
  renderer.set_transfer_function(function);
  return renderer.render(camera, settings);
}

void cpu::attach_preintegration(const scene::PreintegrationCache& cache, IntegratorTables& tables) {
  tables.preintegration = cache.table();
  tables.polynomial = cache.polynomial();
  tables.atlas = cache.atlas();
}

void cpu::note_backend(const RenderSettings& settings, RenderStatistics& statistics) {
  statistics.backend = "cpu";
  statistics.instruction_set = settings.instruction_set.empty() ? best_instruction_set() : settings.instruction_set;
}

std::vector<SourceMethods> cpu_methods() {
  const std::vector<Integrator> both{Integrator::kAntiderivative, Integrator::kPartial, Integrator::kTable3d,
                                     Integrator::kPolynomial, Integrator::kPost};
  std::vector<Integrator> walk = both, march = both;
  walk.push_back(Integrator::kCylindrical);
  march.push_back(Integrator::kPre);
  return {{"cpu", Source::kWalk, walk}, {"cpu", Source::kMarch, march}};
}

std::vector<std::string> instruction_sets() { return cpu::available_instruction_sets(); }

}  // namespace tetravox
