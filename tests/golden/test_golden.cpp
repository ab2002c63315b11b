/// A few pictures of embedded data as a user gets them, against pictures in this folder.
///
/// On a difference the expected, actual and difference pictures are kept in <build>/golden_failures. When a change is
/// meant, look at them, then run tools/approve_golden.sh.

#include "tests/common/image_compare.h"
#include "tests/common/image_file.h"
#include "tetravox/scene.h"

#include <cstdlib>
#include <filesystem>
#include <string>

namespace tetravox::golden {
namespace {

namespace fs = std::filesystem;

struct Picture {
  const char* name;
  const char* builtin;
  const char* preset;  ///< empty: the function from the data's histogram
};

void PrintTo(const Picture& picture, std::ostream* out) { *out << picture.name; }

constexpr Picture kPictures[] = {{"sphere", "sphere", "viridis:peaks=4"},
                                 {"buckyball", "buckyball?cells=50000", ""},
                                 {"duct", "duct", "coolwarm:ramp"}};

Image draw(const Picture& picture) {
  const Dataset dataset = make_builtin(picture.builtin);
  const PreparedMesh mesh = prepare_mesh(dataset.mesh);
  Scene scene;
  scene.data.file = std::string("builtin:") + picture.builtin;
  scene.settings.width = 200;
  scene.settings.height = 150;
  if (*picture.preset) {
    PresetOptions options;
    options.range = mesh.scalar_range;
    scene.transfer_function = make_preset(picture.preset, options);
  }
  const CompletedScene completed = complete_scene(scene, mesh);
  return render(mesh, completed.optical_function, completed.camera, scene.settings);
}

/// What an 8-bit picture over black keeps of `image`.
Image quantise(const Image& image, const fs::path& scratch) {
  tests::write_picture(scratch, image);
  return tests::read_picture(scratch);
}

class Golden : public ::testing::TestWithParam<Picture> {};

TEST_P(Golden, PictureIsAsApproved) {
  const std::string name = GetParam().name;
  const fs::path approved = fs::path(TETRAVOX_GOLDEN_DIR) / (name + ".png");
  const fs::path failures = fs::path(TETRAVOX_BINARY_DIR) / "golden_failures";
  fs::create_directories(failures);
  const fs::path actual_file = failures / (name + ".actual.png");
  const fs::path expected_file = failures / (name + ".expected.png");
  const fs::path difference_file = failures / (name + ".difference.png");
  const Image actual = quantise(draw(GetParam()), actual_file);
  EXPECT_TRUE(tests::is_valid_picture(actual));
  if (std::getenv("TETRAVOX_APPROVE_GOLDEN")) {
    fs::copy_file(actual_file, approved, fs::copy_options::overwrite_existing);
    GTEST_SKIP() << "approved " << approved;
  }
  ASSERT_TRUE(fs::exists(approved)) << "there is no " << approved << ": run tools/approve_golden.sh";
  const Image expected = tests::read_picture(approved);
  // One 8-bit step, for machines whose mathematical functions round otherwise.
  const auto result = tests::images_agree(actual, expected, 1.001 / 255.0, 0.2 / 255.0);
  EXPECT_TRUE(result) << "see " << expected_file << ", " << actual_file << ", " << difference_file;
  if (result) {
    for (const fs::path& file : {actual_file, expected_file, difference_file}) fs::remove(file);
    return;
  }
  fs::copy_file(approved, expected_file, fs::copy_options::overwrite_existing);
  tests::write_picture(difference_file, tests::make_difference_picture(actual, expected, 20.0f));
}

INSTANTIATE_TEST_SUITE_P(Embedded, Golden, ::testing::ValuesIn(kPictures),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace tetravox::golden
