#include "tests/cli/run_tool.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>

namespace tetravox::cli {
namespace {

/// Light, surfaces and clipping between command line, scene and picture.
class Effects : public ToolTest {
 protected:
  /// Draws a small picture and returns its bytes; expects no error.
  std::string draw(const std::string& output, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"--resolution", "32,32", "-o", output});
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return read(output);
  }
  nlohmann::json scene(const std::string& name) const { return nlohmann::json::parse(read(name)); }
  /// A grid of 8^3 values: 1 in its lower half along x, else 0.
  void write_half(const std::string& name) const {
    std::string bytes(512, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = i % 8 < 4 ? '\1' : '\0';
    write(name, bytes);
  }
};

/// Everything that the command line can say beside colours.
const std::vector<std::string> kEverything{"--lights",
                                           "headlight*0.5;directional:1,0,-1:1,0.9,0.8",
                                           "--material",
                                           "0.2,0.6,0.4,16",
                                           "--environment",
                                           "builtin:room",
                                           "--environment-intensity",
                                           "0.5",
                                           "--environment-rotation",
                                           "-30",
                                           "--environment-up",
                                           "0,1,0",
                                           "--gradient-threshold",
                                           "1",
                                           "--two-sided",
                                           "off",
                                           "--shadows",
                                           "volume",
                                           "--shadow-resolution",
                                           "16",
                                           "--ambient-occlusion",
                                           "4",
                                           "--isosurface",
                                           "0.5:1,0,0:0.5",
                                           "--isosurface-back-color",
                                           "0,0,1",
                                           "--one-sided",
                                           "--clip-plane",
                                           "0,0,0,1,0,0",
                                           "--clip-sphere",
                                           "outside:0,0,0,0.1",
                                           "--opacity-weight",
                                           "gradient",
                                           "--opacity-weight-scale",
                                           "0.2"};

TEST_F(Effects, WrongValuesNameTheirOption) {
  const std::vector<std::vector<std::string>> wrong = {{"--lights", ""},
                                                       {"--lights", "directional"},
                                                       {"--lights", "directional:1,2"},
                                                       {"--lights", "point:1,2,3:1,1,1:2"},
                                                       {"--environment", ""},
                                                       {"--environment-intensity", "bright"},
                                                       {"--environment-rotation", "left"},
                                                       {"--environment-up", "0,1"},
                                                       {"--material", "0.1,0.2,0.3"},
                                                       {"--material", "0.1,0.2,0.3,x"},
                                                       {"--gradient-threshold", "x"},
                                                       {"--two-sided", "maybe"},
                                                       {"--isosurface", "1:red"},
                                                       {"--isosurface", "1:0,0,0:1:1"},
                                                       {"--isosurface-back-color", "0,0,2"},
                                                       {"--volume", "maybe"},
                                                       {"--clip-plane", "0,0,0,1,0"},
                                                       {"--clip-box", "0,1,0,1,1,1"},
                                                       {"--clip-box", "outside:0,1"},
                                                       {"--clip-sphere", "0,0,0,0"},
                                                       {"--clip-volume", ""},
                                                       {"--output-depth", "a.png"},
                                                       {"--lights", "sun"},
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
                                                       {"--opacity-weight-scale", "0"}};
  for (const auto& option : wrong) {
    std::vector<std::string> arguments{"render", "builtin:sphere"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    expect_error(run(arguments), 2, {option[0], "--help"});
  }
  expect_error(run({"render", "builtin:sphere", "--material", "2,0,0,1"}), 2, {"material, ambient"});
  expect_error(run({"render", "builtin:sphere", "--environment", "builtin:sky", "--environment-intensity", "-1"}), 2,
               {"environment, intensity"});
  expect_error(run({"render", "builtin:sphere", "--crop", "0,1"}), 2, {"--clip-box", "0,1"});
  expect_error(run({"render", "builtin:sphere", "-o", "a.npy", "--output-depth", "a.npy"}), 2, {"a.npy"});
  EXPECT_TRUE(names().empty());
}

TEST_F(Effects, SavedScenesAndPicturesAreDrawnAgain) {
  for (const std::string data : {"builtin:sphere", "builtin:hydrogen?size=24"}) {
    std::vector<std::string> arguments{data, "--save-scene", "s.json"};
    arguments.insert(arguments.end(), kEverything.begin(), kEverything.end());
    const std::string first = draw("a.exr", arguments);
    ASSERT_EQ(run({"render", "s.json", "-o", "b.exr"}).code, 0);
    EXPECT_EQ(read("b.exr"), first) << data;
    ASSERT_EQ(run({"render", "a.exr", "-o", "c.exr"}).code, 0);
    EXPECT_EQ(read("c.exr"), first) << data;
  }
  const auto json = scene("s.json");
  EXPECT_EQ(json.at("lighting").at("lights").size(), 2u);
  EXPECT_EQ(
      json.at("lighting").at("environment"),
      nlohmann::json({{"file", "builtin:room"}, {"intensity", 0.5}, {"rotation", -30.0}, {"up", {0.0, 1.0, 0.0}}}));
  EXPECT_EQ(json.at("surfaces").at(0).at("back_color"), nlohmann::json({0, 0, 1}));
  EXPECT_EQ(json.at("surfaces").at(0).at("two_sided"), false);
  EXPECT_EQ(json.at("clipping").at("shapes").size(), 2u);
  EXPECT_EQ(json.at("clipping").at("shapes").at(1).at("keep"), "outside");
  EXPECT_EQ(json.at("render").at("opacity_weight"), "gradient");
}

TEST_F(Effects, OptionsGoOverTheScene) {
  std::vector<std::string> arguments{"builtin:sphere", "--save-scene", "s.json"};
  arguments.insert(arguments.end(), kEverything.begin(), kEverything.end());
  draw("a.npy", arguments);
  draw("b.npy", {"s.json", "--save-scene", "b.json", "--lights", "none", "--isosurface", "none", "--crop", "none",
                 "--opacity-weight", "none", "--shadows", "none", "--environment", "none"});
  const auto bare = scene("b.json");
  EXPECT_FALSE(bare.at("lighting").contains("environment"));
  EXPECT_TRUE(bare.at("lighting").at("lights").empty());
  EXPECT_FALSE(bare.contains("surfaces"));
  EXPECT_FALSE(bare.contains("clipping"));
  EXPECT_FALSE(bare.at("render").contains("opacity_weight"));

  draw("c.npy", {"s.json", "--save-scene", "c.json", "--isosurface-back-color", "0,1,0", "--clip-combine", "union"});
  const auto changed = scene("c.json");
  EXPECT_EQ(changed.at("surfaces").at(0).at("back_color"), nlohmann::json({0, 1, 0}));
  EXPECT_EQ(changed.at("clipping").at("combine"), "union");
  EXPECT_EQ(changed.at("clipping").at("shapes").size(), 2u);
}

TEST_F(Effects, WithoutThemScenesAreAsTheyWere) {
  draw("a.npy", {"builtin:sphere", "--save-scene", "s.json"});
  for (const char* key : {"lighting", "surfaces", "clipping"}) EXPECT_FALSE(scene("s.json").contains(key)) << key;
  draw("a.npy", {"builtin:sphere", "--save-scene", "s.json", "--isosurface", "0.5"});
  EXPECT_EQ(scene("s.json").at("lighting").at("lights").at(0).at("kind"), "headlight");
}

TEST_F(Effects, SurroundingsAreLightEnough) {
  const auto light_count = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"builtin:sphere", "--save-scene", "s.json"});
    draw("a.npy", arguments);
    return scene("s.json").at("lighting").at("lights").size();
  };
  EXPECT_EQ(light_count({"--environment", "builtin:studio"}), 0u);
  EXPECT_EQ(light_count({"--environment", "builtin:studio", "--isosurface", "0.5", "--two-sided", "off"}), 0u);
  EXPECT_EQ(light_count({"--environment", "builtin:studio", "--shade"}), 1u);
  EXPECT_EQ(light_count({"--environment", "none", "--isosurface", "0.5"}), 1u);
}

TEST_F(Effects, SurroundingsMoveWithTheirFolder) {
  std::filesystem::create_directories(path("project/sky"));
  // Pictures of our own serve as faces.
  for (const std::string face : {"px", "nx", "py", "ny", "pz", "nz"})
    draw("project/sky/" + face + ".exr", {"builtin:sphere"});
  const std::string first = draw("project/a.png", {"builtin:sphere", "--environment", "project/sky", "--save-scene",
                                                   "project/s.json", "--isosurface", "0.5"});
  EXPECT_EQ(scene("project/s.json").at("lighting").at("environment").at("file"), "sky");
  EXPECT_NE(draw("project/c.png", {"project/s.json", "--environment-rotation", "120"}), first);
  std::filesystem::rename(path("project"), path("moved"));
  for (const std::string input : {"moved/s.json", "moved/a.png"}) EXPECT_EQ(draw("moved/b.png", {input}), first);
  EXPECT_NE(draw("moved/b.png", {"moved/s.json", "--environment", "builtin:sky"}), first);
  expect_error(run({"render", "builtin:sphere", "--environment", "gone.exr"}), 1, {"gone.exr", "cannot open"});
  expect_error(run({"render", "builtin:sphere", "--environment", "moved/a.png"}), 1, {"moved/a.png", "twice as wide"});
  expect_error(run({"render", "builtin:sphere", "--environment", "builtin:moon"}), 1, {"moon", "studio"});
}

TEST_F(Effects, ClipVolumesMoveWithTheirFolder) {
  std::filesystem::create_directories(path("project/masks"));
  write_half("project/masks/half_8x8x8_uint8.raw");
  write("project/data_8x8x8_uint8.raw", read("project/masks/half_8x8x8_uint8.raw"));
  ASSERT_EQ(run({"render", "project/data_8x8x8_uint8.raw", "--clip-volume", "project/masks/half_8x8x8_uint8.raw:0.25",
                 "--resolution", "24,24", "-o", "project/a.png", "--save-scene", "project/s.json"})
                .code,
            0);
  const std::string first = read("project/a.png");
  const auto volume = scene("project/s.json").at("clipping").at("shapes").at(0).at("volume");
  EXPECT_EQ(volume.at("file"), "masks/half_8x8x8_uint8.raw");
  EXPECT_EQ(volume.at("value"), 0.25);

  std::filesystem::rename(path("project"), path("moved"));
  for (const std::string input : {"moved/s.json", "moved/a.png"}) {
    const Result again = run({"render", input, "-o", "moved/b.png"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(read("moved/b.png"), first) << input;
  }
  expect_error(run({"render", "builtin:sphere", "--clip-volume", "gone.nrrd"}), 1, {"gone.nrrd"});
  expect_error(run({"render", "builtin:sphere", "--clip-volume", "builtin:duct"}), 1, {"builtin:duct", "grid"});
}

TEST_F(Effects, DepthIsWrittenBesideThePicture) {
  draw("a.png", {"builtin:sphere", "--isosurface", "0.5", "--output-depth", "z.npy"});
  const std::string bytes = read("z.npy");
  EXPECT_NE(bytes.find("'shape': (32, 32)"), std::string::npos);
  std::vector<float> depth(32 * 32);
  const std::size_t size = depth.size() * sizeof(float);
  ASSERT_GT(bytes.size(), size);
  std::memcpy(depth.data(), bytes.data() + bytes.size() - size, size);
  EXPECT_TRUE(std::isfinite(depth[16 * 32 + 16]));
  EXPECT_GT(depth[16 * 32 + 16], 0.0f);
  EXPECT_TRUE(std::isinf(depth[0]));

  draw("a.png", {"builtin:sphere", "--isosurface", "0.5", "--output-depth", "z.exr"});
  EXPECT_EQ(read("z.exr").substr(0, 4), "\x76\x2f\x31\x01");
  expect_error(run({"render", "builtin:sphere", "--output-depth", "missing/z.exr"}), 1, {"missing/z.exr"});
}

TEST_F(Effects, WhatChangesNothingIsSaid) {
  const auto warning = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", "builtin:sphere", "--resolution", "8,8", "-o", "a.npy"});
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.err;
  };
  EXPECT_NE(warning({"--one-sided"}).find("--isosurface"), std::string::npos);
  EXPECT_NE(warning({"--environment-rotation", "3"}).find("--environment"), std::string::npos);
  EXPECT_NE(warning({"--environment", "builtin:sky", "--shadows", "volume"}).find("--shadows"), std::string::npos);
  EXPECT_NE(warning({"--shade", "--translucency", "0.5"}).find("--translucency"), std::string::npos);
  EXPECT_NE(warning({"--shade", "--translucency-angle", "9"}).find("--shadows half-angle"), std::string::npos);
  EXPECT_NE(warning({"--shade", "--shadow-resolution", "9"}).find("--shadow-resolution"), std::string::npos);
  EXPECT_NE(warning({"--volume", "off", "--variables", "gradient"}).find("--variables changes nothing"),
            std::string::npos);
  EXPECT_NE(warning({"--volume", "off", "--color-array", "distance"}).find("--color-array changes nothing"),
            std::string::npos);
  EXPECT_NE(warning({"--clip-combine", "union"}).find("--clip-combine"), std::string::npos);
  EXPECT_NE(warning({"--opacity-weight-scale", "2"}).find("--opacity-weight-scale"), std::string::npos);
  EXPECT_NE(warning({"--clip-box", "100,101,100,101,100,101"}).find("clipping keeps nothing"), std::string::npos);
}

TEST_F(Effects, EachChangesThePicture) {
  const std::vector<std::vector<std::string>> all = {{"--shade"},
                                                     {"--lights", "directional:1,0,0:1,0.5,0.5*2;point:3,0,0"},
                                                     {"--shade", "--shadows", "volume", "--shadow-resolution", "16"},
                                                     {"--shade", "--shadows", "exact"},
                                                     {"--ambient-occlusion", "3", "--shadow-resolution", "16"},
                                                     {"--environment", "builtin:sky"},
                                                     {"--isosurface", "0.5"},
                                                     {"--isosurface", "0.5:1,0,0:0.5", "--isosurface", "0.8"},
                                                     {"--clip-plane", "0,0,0,1,0,0"},
                                                     {"--crop", "0,1,0,1,-1,1"},
                                                     {"--clip-sphere", "outside:0,0,0,0.7"},
                                                     {"--clip-volume", "builtin:marschner-lobb?size=8:0.5"},
                                                     {"--opacity-weight", "gradient"}};
  for (const std::string input : {"builtin:sphere", "builtin:marschner-lobb?size=12"}) {
    const std::string plain = draw("a.npy", {input});
    for (const auto& options : all) {
      std::vector<std::string> arguments{input};
      arguments.insert(arguments.end(), options.begin(), options.end());
      EXPECT_NE(draw("a.npy", arguments), plain) << input << " " << options[0];
    }
  }
}

TEST_F(Effects, SurfacesAloneAreKept) {
  draw("a.npy", {"builtin:sphere", "--isosurface", "0.6:0.2,0.4,0.9", "--volume", "off", "--save-scene", "s.json"});
  const std::string first = read("a.npy");
  EXPECT_EQ(draw("b.npy", {"s.json"}), first);
  EXPECT_NE(draw("c.npy", {"s.json", "--lights", "none"}), first);
}

TEST_F(Effects, SurfacesOutsideTheRangeAreNamed) {
  const Result with_volume = run({"render", "builtin:sphere", "--isosurface", "7", "-o", "a.png"});
  EXPECT_NE(with_volume.err.find("outside the data's range 0 .. 1: 7"), std::string::npos) << with_volume.err;
  EXPECT_EQ(with_volume.err.find("the picture is empty"), std::string::npos) << with_volume.err;
  const Result alone = run({"render", "builtin:sphere", "--isosurface", "7", "--volume", "off", "-o", "b.png"});
  EXPECT_NE(alone.err.find("outside the data's range 0 .. 1: 7"), std::string::npos) << alone.err;
  EXPECT_NE(alone.err.find("of its iso-surfaces none is seen"), std::string::npos) << alone.err;
}

TEST_F(Effects, APictureAtAFixedRateIsLitAtItAndWithoutIt) {
  draw("fast.png", {"builtin:hydrogen", "--samples-per-voxel", "1"});
  EXPECT_NE(draw("fast-lit.npy", {"fast.png", "--shade"}), draw("fast.npy", {"fast.png"}));
  draw("lit.npy", {"fast.png", "--shade", "--samples-per-voxel", "auto"});
  draw("same.npy", {"builtin:hydrogen", "--shade"});
  EXPECT_EQ(read("lit.npy"), read("same.npy"));
}

TEST_F(Effects, WhatDoesNotGoTogetherIsRefused) {
  expect_error(run({"render", "builtin:hydrogen", "--shade", "--classification", "pre"}), 1, {"pre-classification"});
  const auto at_rate = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"render", "builtin:hydrogen", "--samples-per-voxel", "1"});
    return run(options);
  };
  expect_error(at_rate({"--shade", "--filter", "bspline"}), 1, {"the filter 'linear'", "--samples-per-voxel auto"});
  expect_error(at_rate({"--isosurface", "0.5"}), 1, {"iso-surfaces", "--samples-per-voxel auto"});
  expect_error(at_rate({"--output-depth", "z.npy"}), 1, {"depth", "--samples-per-voxel auto"});
  expect_error(run({"render", "builtin:duct?cells=3000", "--array", "volume", "--isosurface", "1"}), 1, {"point data"});
  expect_error(run({"render", "builtin:sphere", "--gradient", "central"}), 1, {"vertex"});
  expect_error(run({"render", "builtin:sphere", "--clip-volume", "builtin:sphere"}), 1, {"clip volume"});
  expect_error(run({"render", "builtin:sphere", "--clip-volume", "nothing.vti"}), 1, {"nothing.vti"});
}

}  // namespace
}  // namespace tetravox::cli
