#include "tests/cli/run_tool.h"

#include <string>
#include <vector>

namespace tetravox::cli {
namespace {

class Effects : public ToolTest {
 protected:
  /// Draws the sphere and returns the bytes of its picture.
  std::string draw(const std::vector<std::string>& options, const std::string& input = "builtin:sphere") const {
    std::vector<std::string> arguments{"render", input, "--resolution", "48,48", "-o", "a.npy", "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return read("a.npy");
  }
};

TEST_F(Effects, EachChangesThePicture) {
  const std::vector<std::vector<std::string>> all = {{"--shade"},
                                                     {"--lights", "directional:1,0,0:1,0.5,0.5*2;point:3,0,0"},
                                                     {"--shade", "--shadows", "volume", "--shadow-resolution", "16"},
                                                     {"--ambient-occlusion", "3", "--shadow-resolution", "16"},
                                                     {"--isosurface", "0.5"},
                                                     {"--isosurface", "0.5:1,0,0:0.5", "--isosurface", "0.8"},
                                                     {"--clip-plane", "0,0,0,1,0,0"},
                                                     {"--crop", "0,1,0,1,-1,1"},
                                                     {"--clip-sphere", "outside:0,0,0,0.7"},
                                                     {"--clip-volume", "builtin:marschner-lobb?size=8:0.5"},
                                                     {"--opacity-weight", "gradient"}};
  const std::string plain = draw({});
  for (const std::string& input : {std::string("builtin:sphere"), std::string("builtin:marschner-lobb?size=12")})
    for (const auto& options : all) EXPECT_NE(draw(options, input), plain) << input << " " << options[0];
}

TEST_F(Effects, AreKeptInScenes) {
  write("here.txt", "");
  const std::vector<std::string> options = {"--isosurface", "0.6:0.2,0.4,0.9", "--volume",      "off",
                                            "--clip-plane", "0,0,0,1,0.2,0",   "--clip-sphere", "outside:0,0,0,0.3",
                                            "--shadows",    "volume",          "--save-scene",  "scene.json"};
  const std::string first = draw(options);
  EXPECT_EQ(draw({}, "scene.json"), first);
  EXPECT_NE(draw({"--lights", "none"}, "scene.json"), first);
}

TEST_F(Effects, DepthIsWritten) {
  draw({"--isosurface", "0.5", "--output-depth", "depth.npy"});
  EXPECT_EQ(read("depth.npy").size(), 128u + 4u * 48u * 48u);
  draw({"--isosurface", "0.5", "--output-depth", "depth.exr"});
  EXPECT_GT(read("depth.exr").size(), 100u);
}

TEST_F(Effects, MistakesNameTheirOption) {
  const std::vector<std::vector<std::string>> wrong = {{"--lights", "sun"},
                                                       {"--lights", "point"},
                                                       {"--lights", "headlight:1,0,2"},
                                                       {"--lights", "directional:1,0,0*-1"},
                                                       {"--material", "1,2"},
                                                       {"--shadows", "soft"},
                                                       {"--shadow-resolution", "4"},
                                                       {"--ambient-occlusion", "2000"},
                                                       {"--gradient", "steep"},
                                                       {"--isosurface", "x"},
                                                       {"--isosurface", "1:2,0,0"},
                                                       {"--isosurface", "1:1,0,0:3"},
                                                       {"--clip-plane", "0,0,0,0,0,0"},
                                                       {"--clip-sphere", "0,0,0"},
                                                       {"--clip-combine", "xor"},
                                                       {"--opacity-weight", "heavy"},
                                                       {"--opacity-weight-scale", "0"},
                                                       {"--output-depth", "depth.png"}};
  for (const auto& option : wrong)
    expect_error(run({"render", "builtin:sphere", option[0], option[1]}), 2, {option[0]});
}

TEST_F(Effects, WhatDoesNotGoTogetherIsRefused) {
  expect_error(run({"render", "builtin:hydrogen", "--shade", "--classification", "pre"}), 1, {"pre-classification"});
  expect_error(run({"render", "builtin:hydrogen", "--shade", "--samples-per-voxel", "1"}), 1, {"samples per voxel"});
  expect_error(run({"render", "builtin:duct?cells=3000", "--array", "volume", "--isosurface", "1"}), 1, {"point data"});
  expect_error(run({"render", "builtin:sphere", "--gradient", "central"}), 1, {"vertex"});
  expect_error(run({"render", "builtin:sphere", "--clip-volume", "builtin:sphere"}), 1, {"clip volume"});
  expect_error(run({"render", "builtin:sphere", "--clip-volume", "nothing.vti"}), 1, {"nothing.vti"});
}

}  // namespace
}  // namespace tetravox::cli
