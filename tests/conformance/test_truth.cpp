/// Every mesh scene of the shared exact pictures, read from its file and drawn.

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

/// Scenes whose data are unstructured cells, by name; "" where the directory is absent (the test then says SKIPPED).
std::vector<std::string> mesh_scenes() {
  std::vector<std::string> names;
  if (fs::is_directory(kTruth)) {
    for (const auto& entry : fs::directory_iterator(kTruth)) {
      if (entry.path().extension() != ".json") continue;
      std::ifstream file(entry.path());
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      if (text.find(".vtu\"") != std::string::npos) names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  if (names.empty()) names.push_back("");
  return names;
}

class Truth : public ::testing::TestWithParam<std::string> {
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
    std::printf("%s, %s: %s\n", GetParam().c_str(), name_of(integrator).c_str(), tests::describe(difference).c_str());
    EXPECT_TRUE(tests::images_agree(image, truth_, max, rms));
  }

  Scene scene_;
  Dataset dataset_;
  Image truth_;
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
    const Image image = renderer.render(completed.camera, settings);
    std::printf("%s, %s: %s\n", GetParam().c_str(), name_of(integrator).c_str(),
                tests::describe(tests::compare_images(image, truth_)).c_str());
    EXPECT_TRUE(tests::images_agree(image, truth_, max, 2e-4)) << name_of(integrator);
  }
}
#endif

TEST_P(Truth, TheReferenceAgrees) {
  const reference::View view{*scene_.camera, truth_.width, truth_.height, 1, 2, 4};
  const OpticalFunction function = make_optical_function(*scene_.transfer_function, 1.0);
  const Image image = reference::draw(reference::make_tetrahedra(dataset_.mesh), function, view);
  EXPECT_TRUE(tests::images_agree(image, reference::pick_pixels(truth_, view), 5e-6));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Truth, ::testing::ValuesIn(mesh_scenes()), [](const auto& test) {
  std::string name = test.param.empty() ? "absent" : test.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace tetravox::conformance
