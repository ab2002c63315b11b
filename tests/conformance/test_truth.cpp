/// Every scene of the shared exact pictures, read from its file and drawn.

#ifdef TETRAVOX_WITH_GL
#include "tests/common/gl.h"
#endif
#include "tests/common/image_compare.h"
#include "tests/common/image_file.h"
#include "tests/reference/integrator.h"
#include "tetravox/io.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace tetravox::conformance {
namespace {

namespace fs = std::filesystem;

const fs::path kTruth = fs::path(TETRAVOX_SHARED_DIR) / "truth";

/// Scenes whose data are meshes, or grids, by name; "" where the directory is absent (the test then says SKIPPED).
std::vector<std::string> find_scenes(bool are_grids) {
  std::vector<std::string> names;
  if (fs::is_directory(kTruth)) {
    for (const auto& entry : fs::directory_iterator(kTruth)) {
      if (entry.path().extension() != ".json") continue;
      std::ifstream file(entry.path());
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      if ((text.find(".vtu\"") == std::string::npos) == are_grids) names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  if (names.empty()) names.push_back("");
  return names;
}

class SharedScene : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (GetParam().empty()) GTEST_SKIP() << "there are no exact pictures in " << kTruth;
    const fs::path path = kTruth / (GetParam() + ".json");
    std::ifstream file(path);
    scene_ = parse_scene({std::istreambuf_iterator<char>(file), {}}, path.string());
    ReadOptions options;
    options.array = scene_.data.array;
    options.time = scene_.data.time;
    dataset_ = read_dataset((kTruth / scene_.data.file).string(), options);
    truth_ = tests::read_picture(kTruth / (GetParam() + ".npy"));
  }

  /// Compares and says by how much they differ.
  void expect_close(const Image& image, const std::string& method, double max, double rms) const {
    std::printf("%s, %s: %s\n", GetParam().c_str(), method.c_str(),
                tests::describe(tests::compare_images(image, truth_)).c_str());
    EXPECT_TRUE(tests::images_agree(image, truth_, max, rms)) << method;
  }

  Scene scene_;
  Dataset dataset_;
  Image truth_;
};

class Truth : public SharedScene {
 protected:
  Image draw(Integrator integrator) const {
    const PreparedMesh mesh = prepare_mesh(dataset_.mesh);
    const CompletedScene completed = complete_scene(scene_, mesh);
    RenderSettings settings = scene_.settings;
    settings.integrator = integrator;
    EXPECT_EQ(settings.width, truth_.width);
    EXPECT_EQ(settings.height, truth_.height);
    return render(mesh, completed.optical_function, completed.camera, settings);
  }

  void expect_close(Integrator integrator, double max, double rms) const {
    const Image image = draw(integrator);
    const tests::ImageDifference difference = tests::compare_images(image, truth_);
    RecordProperty("max", std::to_string(difference.max));
    RecordProperty("rms", std::to_string(difference.rms));
    SharedScene::expect_close(image, name_of(integrator), max, rms);
  }
};

TEST_P(Truth, AntiderivativeIsWithinHalfAnEightBitStep) { expect_close(Integrator::kAntiderivative, 2e-3, 2e-4); }

TEST_P(Truth, PartialIsExact) { expect_close(Integrator::kPartial, 2e-4, 2e-4); }

#ifdef TETRAVOX_WITH_GL
TEST_P(Truth, OpenGlIsAsExact) {
  TETRAVOX_REQUIRE_GL();
  const PreparedMesh mesh = prepare_mesh(dataset_.mesh);
  const CompletedScene completed = complete_scene(scene_, mesh);
  Renderer renderer = make_gl_renderer(mesh);
  renderer.set_transfer_function(completed.optical_function);
  for (const auto& [integrator, max] : {std::pair{Integrator::kAntiderivative, 2e-3}, {Integrator::kPartial, 2e-4}}) {
    RenderSettings settings = scene_.settings;
    settings.integrator = integrator;
    SharedScene::expect_close(renderer.render(completed.camera, settings), "gl walk " + name_of(integrator), max, 2e-4);
  }
  // Cells are put in order, so that every order that is wrong anywhere is seen.
  for (const Source source : {Source::kProject, Source::kVicp}) {
    RenderSettings settings = scene_.settings;
    settings.source = source;
    SharedScene::expect_close(renderer.render(completed.camera, settings), "gl " + name_of(source), 5e-3, 5e-4);
  }
}
#endif

TEST_P(Truth, TheReferenceAgrees) {
  const reference::View view{*scene_.camera, truth_.width, truth_.height, 1, 2, 4};
  const OpticalFunction function = make_optical_function(*scene_.transfer_function, 1.0);
  const Image image = reference::draw(reference::make_tetrahedra(dataset_.mesh), function, view);
  EXPECT_TRUE(tests::images_agree(image, reference::pick_pixels(truth_, view), 5e-6));
}

class GridTruth : public SharedScene {
 protected:
  /// By both exact integrators.
  void expect_exact(Renderer& renderer, const CompletedScene& completed, const std::string& backend) const {
    renderer.set_transfer_function(completed.optical_function);
    for (const Integrator integrator : {Integrator::kAntiderivative, Integrator::kPartial}) {
      RenderSettings settings = scene_.settings;
      settings.integrator = integrator;
      expect_close(renderer.render(completed.camera, settings), backend + " march " + name_of(integrator), 3e-3, 3e-4);
    }
  }
};

TEST_P(GridTruth, GridsAreWithinTheirTolerance) {
  const PreparedGrid grid = prepare_grid(dataset_.grid);
  Renderer renderer(grid);
  expect_exact(renderer, complete_scene(scene_, grid), "cpu");
}

#ifdef TETRAVOX_WITH_GL
TEST_P(GridTruth, OpenGlIsAsExact) {
  TETRAVOX_REQUIRE_GL();
  const PreparedGrid grid = prepare_grid(dataset_.grid);
  Renderer renderer = make_gl_renderer(grid);
  expect_exact(renderer, complete_scene(scene_, grid), "gl");
}
#endif

std::string test_name(const ::testing::TestParamInfo<std::string>& test) {
  std::string name = test.param.empty() ? "absent" : test.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Truth, ::testing::ValuesIn(find_scenes(false)), test_name);
INSTANTIATE_TEST_SUITE_P(Scenes, GridTruth, ::testing::ValuesIn(find_scenes(true)), test_name);

}  // namespace
}  // namespace tetravox::conformance
