/// Embedded data against the project's own exact pictures: hard functions, many cameras.

#include "tests/common/image_compare.h"
#include "tests/conformance/scenes.h"
#include "tests/reference/integrator.h"

#include <cmath>
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

/// Draws `mesh` with both exact integrators and holds the pictures against the reference.
void expect_agreement(const MeshData& data, const OpticalFunction& function, const reference::View& view,
                      const char* what) {
  const PreparedMesh mesh = prepare_mesh(data);
  const Image expected = reference::draw(reference::make_tetrahedra(data), function, view);
  EXPECT_GT(tests::count_covered(expected), 20u) << what;
  for (const Integrator integrator : tests::kExactIntegrators) {
    const Image actual = render(mesh, function, view.camera, tests::make_settings(integrator, view.width, view.height));
    const tests::ImageDifference difference = tests::compare_images(actual, expected);
    std::printf("%-28s %-14s max %.2e RMS %.2e\n", what, name_of(integrator).c_str(), difference.max, difference.rms);
    EXPECT_TRUE(agrees(actual, expected, integrator)) << what << " " << name_of(integrator);
  }
}

TEST(Pictures, MayHaveAnyShape) {
  const Dataset duct = make_builtin("duct?cells=4000");
  const Subject scene = make_subject(duct.mesh);
  expect_agreement(duct.mesh, scene.function("smooth"), {scene.camera("outside"), 197, 13}, "wide");
  expect_agreement(duct.mesh, scene.function("smooth"), {scene.camera("inside"), 11, 163}, "tall");
  expect_agreement(duct.mesh, scene.function("smooth"), {scene.camera("orthographic"), 131, 29}, "wide, orthographic");
}

TEST(Pictures, OfTheMiddleOfSmallCells) {
  const Dataset ball = make_builtin("buckyball?cells=100000");
  const Subject scene = make_subject(ball.mesh);
  Camera camera = scene.camera("inside");
  for (const double angle : {0.5, 10.0, 150.0}) {
    camera.view_angle = angle;
    expect_agreement(ball.mesh, scene.function("random"), {camera, 48, 36}, "inside, any angle");
  }
}

TEST(Functions, MayHaveThousandsOfControlPoints) {
  const Dataset ball = make_builtin("buckyball?cells=20000");
  const Subject scene = make_subject(ball.mesh);
  for (const int count : {300, 3000}) {
    OpticalFunction function;
    for (int i = 0; i < count; ++i) {
      const double u = i / (count - 1.0), wave = 0.5 + 0.5 * std::sin(i * 2.399963);
      function.points.push_back(
          {scene.mesh.scalar_range.min + u * (scene.mesh.scalar_range.max - scene.mesh.scalar_range.min),
           20.0 * wave / tests::diagonal_of(scene.mesh.bounds),
           {wave, u, 0.5 + 0.5 * std::cos(i * 1.7)}});
    }
    expect_agreement(ball.mesh, function, {scene.camera("outside"), 64, 48}, "thousands of control points");
  }
}

/// A field over six decades with a function whose points are equally far apart in its logarithm.
TEST(Functions, MayBeLogarithmic) {
  tests::BoxOptions options;
  options.bricks = {24, 6, 6};
  const MeshData mesh = tests::make_box(options, [](const Vector3& p) { return std::pow(10.0, 3.0 * p[0]); });
  OpticalFunction function;
  const Color colors[] = {{0.1, 0.2, 0.9}, {0.2, 0.9, 0.4}, {0.9, 0.3, 0.1}};
  for (int i = 0; i <= 24; ++i)
    function.points.push_back({std::pow(10.0, -3.0 + 0.25 * i), i % 2 == 0 ? 0.1 : 2.0, colors[i % 3]});
  const std::vector<tests::NamedCamera> cameras = tests::make_cameras(prepare_mesh(mesh).bounds);
  for (const auto& [name, camera] : cameras)
    expect_agreement(mesh, function, {camera, 64, 48}, ("logarithmic, " + name).c_str());
}

/// One narrow peak of two colours, alone and in a function a hundred times wider than the field.
TEST(Functions, MayBeNarrow) {
  const Dataset sphere = make_builtin("sphere");
  const Subject scene = make_subject(sphere.mesh);
  const ValueRange range = scene.mesh.scalar_range;
  const double middle = range.min + 0.61 * (range.max - range.min);
  for (const double width : {1e-2, 1e-3, 1e-4}) {
    const double half = width * (range.max - range.min);
    // The peak's area stays the same.
    const double peak = 1.0 / half;
    const OpticalFunction function{{{middle - half, 0.0, {0.9, 0.5, 0.1}},
                                    {middle, peak, {0.9, 0.8, 0.2}},
                                    {middle + half, 0.0, {0.2, 0.5, 0.9}}}};
    expect_agreement(sphere.mesh, function, {scene.camera("outside"), 64, 48},
                     ("peak of half width " + std::to_string(width)).c_str());
    OpticalFunction wide = function;
    wide.points.insert(wide.points.begin(), {range.min - 100.0 * (range.max - range.min), 0.0, {0, 0, 0}});
    wide.points.push_back({range.max + 100.0 * (range.max - range.min), 0.0, {0, 0, 0}});
    expect_agreement(sphere.mesh, wide, {scene.camera("outside"), 64, 48}, "the same, function wider than the field");
  }
}

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
