/// Embedded data against the project's own exact pictures: hard functions, many cameras.

#include "tests/common/image_compare.h"
#include "tests/conformance/scenes.h"
#include "tests/reference/integrator.h"

#include <cstdio>

namespace tetravox::conformance {
namespace {

struct Case {
  const char* name;
  const char* builtin;  ///< empty: the mesh with cell data
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class ReferencePictures : public ::testing::TestWithParam<Case> {
 protected:
  static Subject subject() {
    return *GetParam().builtin ? make_subject(GetParam().builtin) : make_subject(make_cell_data_mesh());
  }
};

TEST_P(ReferencePictures, AreDrawn) {
  const Subject scene = subject();
  const reference::Tetrahedra tetrahedra = reference::make_tetrahedra(scene.dataset.mesh);
  EXPECT_EQ(tetrahedra.cells.size(), scene.mesh.cells.size());
  for (const auto& [camera_name, camera] : scene.cameras) {
    Renderer renderer(scene.mesh);
    for (const auto& [function_name, function] : scene.functions) {
      const Image expected = reference::draw(tetrahedra, function, {camera, 80, 60});
      EXPECT_GT(tests::count_covered(expected), 480u) << camera_name << " " << function_name;
      renderer.set_transfer_function(function);
      for (const Integrator integrator : tests::kExactIntegrators) {
        const Image actual = renderer.render(camera, tests::make_settings(integrator, 80, 60));
        const tests::ImageDifference difference = tests::compare_images(actual, expected);
        std::printf("%-14s %-12s %-7s %-14s max %.2e RMS %.2e\n", GetParam().name, camera_name.c_str(),
                    function_name.c_str(), name_of(integrator).c_str(), difference.max, difference.rms);
        EXPECT_TRUE(agrees(actual, expected, integrator))
            << camera_name << " " << function_name << " " << name_of(integrator);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Data, ReferencePictures,
                         ::testing::Values(Case{"sphere", "sphere"}, Case{"buckyball", "buckyball?cells=20000"},
                                           Case{"duct", "duct"}, Case{"cell_data", ""}),
                         [](const auto& test) { return test.param.name; });

/// RMS error of `post` with `samples` samples a segment.
double post_error(Renderer& renderer, const Camera& camera, const Image& expected, int samples) {
  RenderSettings settings = tests::make_settings(Integrator::kPost, expected.width, expected.height);
  settings.samples = samples;
  return tests::compare_images(renderer.render(camera, settings), expected).rms;
}

TEST(Post, ConvergesWithMoreSamples) {
  const Subject scene = make_subject("buckyball?cells=20000");
  const reference::Tetrahedra tetrahedra = reference::make_tetrahedra(scene.dataset.mesh);
  Renderer renderer(scene.mesh);
  for (const char* name : {"smooth", "random", "spikes", "steps"}) {
    const Camera& camera = scene.camera("outside");
    const Image expected = reference::draw(tetrahedra, scene.function(name), {camera, 64, 48});
    renderer.set_transfer_function(scene.function(name));
    const double coarse = post_error(renderer, camera, expected, 4);
    const double fine = post_error(renderer, camera, expected, 64);
    const double finest = post_error(renderer, camera, expected, 1024);
    std::printf("post, %s: RMS %.2e with 4 samples, %.2e with 64, %.2e with 1024\n", name, coarse, fine, finest);
    // At least first order until rounding: 16 times the samples, an eighth of the error.
    EXPECT_LT(fine, std::max(coarse / 8.0, 2e-5)) << name;
    EXPECT_LT(finest, std::max(fine / 8.0, 1e-4)) << name;
  }
}

TEST(Post, OneSampleASegmentIsRoughButSane) {
  const Subject scene = make_subject("duct");
  Renderer renderer(scene.mesh);
  for (const auto& [name, function] : scene.functions) {
    renderer.set_transfer_function(function);
    RenderSettings settings = tests::make_settings(Integrator::kPost, 64, 48);
    settings.samples = 1;
    EXPECT_TRUE(tests::is_valid_picture(renderer.render(scene.camera("outside"), settings))) << name;
  }
}

}  // namespace
}  // namespace tetravox::conformance
