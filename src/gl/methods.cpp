#include "tetravox/gl.h"

namespace tetravox {

std::vector<SourceMethods> gl_methods() {
  const std::vector<Integrator> both{Integrator::kAntiderivative, Integrator::kPartial, Integrator::kTable3d,
                                     Integrator::kPolynomial, Integrator::kPost};
  std::vector<Integrator> meshes = both, grids = both;
  meshes.push_back(Integrator::kCylindrical);
  grids.push_back(Integrator::kPre);
  return {{"gl", Source::kWalk, meshes},
          {"gl", Source::kProject, meshes},
          {"gl", Source::kVicp, meshes},
          {"gl", Source::kMarch, grids},
          {"gl", Source::kSlices, grids}};
}

}  // namespace tetravox
