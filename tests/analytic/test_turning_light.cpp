/// Light on coarse data, where normals turn within a cell: against the model, sampled finely along every ray.

#include "tests/analytic/light_model.h"
#include "tests/analytic/show.h"
#include "tests/analytic/traced_field.h"
#include "tests/common/functions.h"
#include "tests/common/grid_builder.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace tetravox::analytic {
namespace {

constexpr int kSteps = 400;  // a span; an error of 1e-4

struct Turning {
  bool is_grid = false;
  std::uint32_t seed = 1;
  double threshold = 2.0;
  bool has_many_lights = false;
};

void PrintTo(const Turning& turning, std::ostream* out) {
  *out << (turning.is_grid ? "grid" : "mesh") << " seed " << turning.seed << " threshold " << turning.threshold
       << (turning.has_many_lights ? " many lights" : " headlight");
}

class TurningLight : public ::testing::TestWithParam<Turning> {
 protected:
  struct Drawn {
    tests::Body body;
    TraceField trace;
  };
  static Drawn make() {
    const Turning& param = GetParam();
    const tests::Field field = tests::make_random_field(param.seed, 1.5);
    if (param.is_grid) {
      tests::GridOptions options;
      options.dimensions = {20, 19, 21};
      const GridData grid = tests::make_grid(options, field);
      return {grid, trace_grid(grid)};
    }
    tests::BoxOptions options;
    options.bricks = {7, 8, 6};
    options.type = CellType::kTetrahedron;
    const MeshData mesh = tests::make_box(options, field);
    return {mesh, trace_tetrahedra(mesh)};
  }
  static Lighting make_lighting() {
    Lighting lighting;
    lighting.lights = {Light{}};
    if (GetParam().has_many_lights) lighting = make_lights();
    lighting.gradient_threshold = GetParam().threshold;
    return lighting;
  }
};

TEST_P(TurningLight, KeepsThePicturesTolerance) {
  const Drawn drawn = make();
  const ValueRange range = drawn.body.scalar_range();
  const double diagonal = tests::diagonal_of(drawn.body.bounds());
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 48, 36);
  settings.use_early_ray_termination = false;
  settings.lighting = make_lighting();
  const double half = settings.lighting.gradient_threshold * (range.max - range.min) / diagonal;
  for (const tests::NamedFunction& named : tests::make_hard_functions(range, diagonal)) {
    if (named.name == "random" || named.name == "steps") continue;  // what such steps miss is not the light
    const auto camera = standard_cameras()[GetParam().seed % 2];
    const Image image = drawn.body.draw(named.function, camera.second, settings);
    Image expected = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Ray ray = make_ray(camera.second, image.width, image.height, x, y);
        const auto medium_at = [&](const FieldSample& sample, const Vector3& place) {
          const OpticalPoint point = eval_optical_function(named.function, sample.value);
          const double square = dot(sample.gradient, sample.gradient);
          const double strength = square / std::max(square + half * half, 1e-300);
          const Illumination light = illuminate(settings.lighting, ray.direction, place, sample.gradient, strength);
          return Medium{point.extinction, light.apply(point.color)};
        };
        const Rgba wanted = integrate_traced(drawn.trace, ray, medium_at, kSteps);
        for (int k = 0; k < 4; ++k) expected.pixel(x, y)[k] = static_cast<float>(wanted[k]);
      }
    EXPECT_TRUE(tests::images_agree(image, expected, 5e-3, 3e-4)) << named.name << " " << camera.first;
  }
}

TEST_P(TurningLight, GivesTheSameBytesWithEveryInstructionSet) {
  // Rays side by side are cut into different numbers of parts.
  const Drawn drawn = make();
  const double diagonal = tests::diagonal_of(drawn.body.bounds());
  RenderSettings settings = tests::make_settings(Integrator::kAntiderivative, 67, 51);
  settings.lighting = make_lighting();
  const auto camera = standard_cameras()[GetParam().seed % 2].second;
  for (const tests::NamedFunction& named : tests::make_hard_functions(drawn.body.scalar_range(), diagonal)) {
    settings.instruction_set.clear();
    const Image image = drawn.body.draw(named.function, camera, settings);
    for (const std::string& set : instruction_sets()) {
      settings.instruction_set = set;
      EXPECT_TRUE(tests::images_equal(drawn.body.draw(named.function, camera, settings), image))
          << named.name << " " << set;
    }
  }
}

std::string name_turning(const ::testing::TestParamInfo<Turning>& info) {
  return std::string(info.param.is_grid ? "Grid" : "Mesh") + std::to_string(info.param.seed) +
         (info.param.has_many_lights ? "Many" : "Head") + (info.param.threshold > 1.0 ? "Usual" : "Sharp");
}

INSTANTIATE_TEST_SUITE_P(Data, TurningLight,
                         ::testing::Values(Turning{false, 1, 2.0, false}, Turning{false, 2, 2.0, true},
                                           Turning{false, 3, 0.5, true}, Turning{true, 1, 2.0, false},
                                           Turning{true, 2, 2.0, true}, Turning{true, 3, 0.5, true}),
                         name_turning);

}  // namespace
}  // namespace tetravox::analytic
