#include "tests/cli/run_tool.h"

#include <nlohmann/json.hpp>

namespace tetravox::cli {
namespace {

class Scenes : public ToolTest {};

TEST_F(Scenes, PictureIsDrawnAgainByteForByte) {
  for (const std::string ending : {".png", ".exr"}) {
    ASSERT_EQ(run({"render", "builtin:duct", "--resolution", "120,90", "--transfer-function", "coolwarm:peaks=4",
                   "--camera-azimuth", "33.3", "--background", "0.1,0.2,0.3", "-o", "a" + ending})
                  .code,
              0);
    const Result again = run({"render", "a" + ending, "-o", "b" + ending});
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(read("a" + ending), read("b" + ending)) << ending;
  }
}

TEST_F(Scenes, DefaultsAreDrawnAgainByteForByte) {
  ASSERT_EQ(run({"render", "builtin:sphere", "--alpha", "--bit-depth", "16", "--resolution", "64,64"}).code, 0);
  ASSERT_EQ(run({"render", "sphere.png", "-o", "b.png"}).code, 0);
  EXPECT_EQ(read("sphere.png"), read("b.png"));
}

TEST_F(Scenes, SavedSceneGivesTheSamePicture) {
  ASSERT_EQ(
      run({"render", "builtin:sphere", "--resolution", "64,48", "-o", "a.npy", "--save-scene", "s/scene.json"}).code, 1)
      << "the directory is missing";
  std::filesystem::create_directory(path("s"));
  ASSERT_EQ(
      run({"render", "builtin:sphere", "--resolution", "64,48", "-o", "a.npy", "--save-scene", "s/scene.json"}).code,
      0);
  ASSERT_EQ(run({"render", "s/scene.json", "-o", "b.npy"}).code, 0);
  EXPECT_EQ(read("a.npy"), read("b.npy"));
  const auto json = nlohmann::json::parse(read("s/scene.json"));
  EXPECT_EQ(json.at("tetravox"), 1);
  EXPECT_EQ(json.at("data").at("file"), "builtin:sphere");
  EXPECT_TRUE(json.contains("transfer_function"));
  EXPECT_TRUE(json.contains("camera"));
}

TEST_F(Scenes, FolderCanBeMovedAndSeenFromAnywhere) {
  write_tetrahedron("project/data/one.vtk");
  std::filesystem::create_directory(path("project/pictures"));
  ASSERT_EQ(run({"render", "project/data/one.vtk", "-o", "project/pictures/one.png", "--resolution", "32,32",
                 "--save-scene", "project/one.json"})
                .code,
            0);
  const std::string first = read("project/pictures/one.png");
  EXPECT_EQ(nlohmann::json::parse(read("project/one.json")).at("data").at("file"), "data/one.vtk");

  std::filesystem::rename(path("project"), path("moved"));
  const Result picture = run({"render", "moved/pictures/one.png", "-o", "moved/pictures/two.png"});
  ASSERT_EQ(picture.code, 0) << picture.err;
  EXPECT_EQ(read("moved/pictures/two.png"), first);
  const Result scene = run({"render", "moved/one.json", "-o", "moved/pictures/three.png"});
  ASSERT_EQ(scene.code, 0) << scene.err;
  EXPECT_EQ(read("moved/pictures/three.png"), first);
}

TEST_F(Scenes, OptionsGoOverTheScene) {
  write("s.json", R"({"tetravox": 1, "data": {"file": "builtin:sphere"}, "image": {"resolution": [40, 30]},
    "transfer_function": {"points": [{"value": 0, "color": [1, 0, 0], "extinction": 9},
                                     {"value": 1, "color": [0, 0, 1], "extinction": 9}]}})");
  ASSERT_EQ(run({"render", "s.json", "-o", "a.npy"}).code, 0);
  ASSERT_EQ(run({"render", "s.json", "-o", "b.npy", "--invert"}).code, 0);
  ASSERT_EQ(run({"render", "s.json", "-o", "c.npy", "--range", "0,0.5"}).code, 0);
  EXPECT_NE(read("a.npy"), read("b.npy"));
  EXPECT_NE(read("a.npy"), read("c.npy"));
  const Result result = run({"render", "s.json", "-o", "d.png", "--resolution", "80,60"});
  EXPECT_NE(result.out.find("80 x 60"), std::string::npos) << result.out;
  expect_error(run({"render", "s.json", "-o", "d.png", "--unit-distance", "2"}), 2, {"--unit-distance", "extinctions"});
}

TEST_F(Scenes, TransferFunctionFiles) {
  write("own.json", R"({"points": [{"value": 0.2, "color": [1, 0, 0], "opacity": 0},
                                   {"value": 0.8, "color": [0, 0, 1], "opacity": 0.5}]})");
  write("paraview.json", R"([{"Name": "One", "ColorSpace": "RGB", "RGBPoints": [0, 1, 0, 0, 1, 0, 0, 1]},
                             {"Name": "Two", "ColorSpace": "RGB", "RGBPoints": [0, 0, 1, 0, 1, 1, 1, 1]}])");
  const std::vector<std::string> start{"render", "builtin:sphere", "--resolution", "32,32", "-o"};
  const auto draw = [&](const std::string& output, std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "builtin:sphere", "--resolution", "32,32", "-o", output});
    return run(more);
  };
  EXPECT_EQ(draw("a.npy", {"--transfer-function", "own.json"}).code, 0);
  EXPECT_EQ(draw("b.npy", {"--transfer-function", "own.json", "--range", "0,1"}).code, 0);
  EXPECT_EQ(draw("c.npy", {"--transfer-function", "paraview.json", "--preset-name", "One"}).code, 0);
  EXPECT_EQ(draw("d.npy", {"--transfer-function", "paraview.json", "--preset-name", "Two"}).code, 0);
  EXPECT_NE(read("a.npy"), read("b.npy"));
  EXPECT_NE(read("c.npy"), read("d.npy"));
  expect_error(draw("e.npy", {"--transfer-function", "paraview.json", "--preset-name", "Three"}), 1, {"paraview.json"});
  expect_error(draw("e.npy", {"--transfer-function", "none.json"}), 1, {"none.json"});
  expect_error(draw("e.npy", {"--transfer-function", "virdis"}), 1, {"virdis", "viridis"});
}

TEST_F(Scenes, WrongScenesAreOneLine) {
  write("a.json", "{");
  expect_error(run({"render", "a.json"}), 1, {"a.json"});
  write("a.json", R"({"tetravox": 1, "data": {"file": "builtin:sphere"}, "camera": {"positoin": [0, 0, 1]}})");
  expect_error(run({"render", "a.json"}), 1, {"a.json", "positoin"});
  write("a.json", R"({"tetravox": 1, "data": {"file": "gone.vtu"}})");
  expect_error(run({"render", "a.json"}), 1, {"gone.vtu"});
  ASSERT_EQ(run({"render", "builtin:sphere", "-o", "a.png", "--resolution", "8,8"}).code, 0);
  const std::string png = read("a.png");
  write("cut.png", png.substr(0, 60));
  expect_error(run({"render", "cut.png", "-o", "b.png"}), 1, {"cut.png"});
  write("other.exr", "no picture");
  expect_error(run({"render", "other.exr", "-o", "b.png"}), 1, {"other.exr"});
  expect_error(run({"render", "a.png"}), 2, {"a.png", "--output"});
}

}  // namespace
}  // namespace tetravox::cli
