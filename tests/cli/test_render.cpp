#include "tests/cli/run_tool.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <set>

namespace tetravox::cli {
namespace {

class Render : public ToolTest {
 protected:
  /// Floats of an .npy picture; checks its shape.
  std::vector<float> read_pixels(const std::string& name, int width, int height) const {
    const std::string bytes = read(name);
    const std::string shape = "'shape': (" + std::to_string(height) + ", " + std::to_string(width) + ", 4)";
    EXPECT_NE(bytes.find(shape), std::string::npos);
    std::vector<float> pixels(4 * static_cast<std::size_t>(width) * height);
    const std::size_t size = pixels.size() * sizeof(float);
    if (bytes.size() < size) return {};
    std::memcpy(pixels.data(), bytes.data() + bytes.size() - size, size);
    return pixels;
  }
  /// Draws `arguments` at 64 x 64 into an array, and expects no error.
  std::vector<float> draw(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"-o", "draw.npy", "--resolution", "64,64"});
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return read_pixels("draw.npy", 64, 64);
  }
};

TEST_F(Render, EachBuiltinWithoutOptions) {
  for (const std::string name : {"sphere", "buckyball", "duct"}) {
    const Result result = run({"render", "builtin:" + name});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_NE(result.out.find("wrote " + name + ".png: 512 x 512"), std::string::npos) << result.out;
    const std::string png = read(name + ".png");
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_GT(png.size(), 4000u) << "that is an empty picture";
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"buckyball.png", "duct.png", "sphere.png"}));
}

TEST_F(Render, QuietSaysNothing) {
  const Result result = run({"render", "builtin:sphere", "--quiet", "--resolution", "16,16"});
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST_F(Render, StatisticsHaveTheirKeys) {
  const Result result = run({"render", "builtin:duct", "--resolution", "100,80", "--repeat", "3", "--statistics",
                             "s.json", "--threads", "2", "--integrator", "partial"});
  ASSERT_EQ(result.code, 0) << result.err;
  const auto json = nlohmann::json::parse(read("s.json"));
  for (const char* key : {"read", "prepare", "choose", "transfer_function", "first_frame", "frame", "write", "total"})
    EXPECT_GE(json.at("seconds").at(key).get<double>(), 0.0) << key;
  EXPECT_GT(json.at("seconds").at("frame").get<double>(), 0.0);
  for (const char* key : {"input", "mesh", "frame", "peak_rss"})
    EXPECT_GT(json.at("bytes").at(key).get<std::uint64_t>(), 0u) << key;
  EXPECT_TRUE(json.at("bytes").at("reader_peak_rss").is_number_unsigned());
  EXPECT_GT(json.at("segments").get<std::uint64_t>(), json.at("rays").get<std::uint64_t>());
  EXPECT_EQ(json.at("stopped_rays"), 0);
  EXPECT_EQ(json.at("frames"), 3);
  EXPECT_EQ(json.at("threads"), 2);
  EXPECT_EQ(json.at("backend"), "cpu");
  EXPECT_EQ(json.at("source"), "walk");
  EXPECT_EQ(json.at("integrator"), "partial");
  EXPECT_EQ(json.at("resolution"), (nlohmann::json{100, 80}));
  EXPECT_FALSE(json.at("isa").get<std::string>().empty());
  EXPECT_GT(json.at("prepare").at("tetrahedra").get<std::uint64_t>(), 0u);
}

TEST_F(Render, TablesOfRayIntegrals) {
  const std::vector<std::vector<std::string>> variants = {
      {"--integrator", "table3d", "--preintegration-size", "60,20", "--preintegration-lengths", "uniform"},
      {"--integrator", "polynomial=3", "--preintegration-size", "60", "--preintegration-opacity", "linear"},
      {"--integrator", "cylindrical", "--preintegration-planes", "9", "--preintegration-tile", "30",
       "--preintegration-bits", "12"}};
  std::set<std::vector<float>> pictures;
  for (std::vector<std::string> arguments : variants) {
    arguments.insert(arguments.begin(), "builtin:duct");
    arguments.insert(arguments.end(),
                     {"--preintegration-steps", "8", "--save-scene", "s.json", "--statistics", "t.json"});
    const std::vector<float> picture = draw(arguments);
    EXPECT_TRUE(pictures.insert(picture).second);
    EXPECT_EQ(draw({"s.json"}), picture);
    const auto json = nlohmann::json::parse(read("t.json"));
    EXPECT_EQ(json.at("integrator").get<std::string>(), arguments[2].substr(0, arguments[2].find('=')));
    EXPECT_GT(json.at("seconds").at("transfer_function").get<double>(), 0.0);
    EXPECT_GT(json.at("bytes").at("frame").get<std::uint64_t>(), 0u);
  }
  const auto expect_warning = [&](std::vector<std::string> more, const std::string& text) {
    more.insert(more.begin(), {"render", "builtin:sphere", "--resolution", "16,16"});
    const Result result = run(more);
    EXPECT_EQ(result.code, 0);
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
  };
  expect_warning({"--preintegration-planes", "9"},
                 "--preintegration-planes changes nothing: it is for --integrator cylindrical");
  expect_warning({"--integrator", "polynomial=1", "--preintegration-size", "20,30"},
                 "the second number of --preintegration-size changes nothing: it is for --integrator table3d");
}

TEST_F(Render, OptionsChangeThePicture) {
  const std::string input = "builtin:sphere";
  std::set<std::vector<float>> pictures{draw({input})};
  const std::vector<std::vector<std::string>> variants = {
      {"--transfer-function", "viridis"},
      {"--transfer-function", "viridis", "--invert"},
      {"--transfer-function", "viridis:peaks=3"},
      {"--range", "0.25,0.5"},
      {"--range", "-0.5,1"},
      {"--range", "0.1,1", "--log"},
      {"--transfer-function", "inferno:ramp", "--range", "0.1,1", "--log"},
      {"--invert"},
      {"--unit-distance", "0.5"},
      {"--camera-azimuth", "-30"},
      {"--camera-elevation", "20"},
      {"--camera-zoom", "1.5"},
      {"--camera-view-angle", "50"},
      {"--camera-parallel-scale", "0.8"},
      {"--camera-position", "-3,-1.5,.5", "--camera-focal-point", "0,0,0", "--camera-view-up", "0,1,0"}};
  for (const auto& variant : variants) {
    std::vector<std::string> arguments{input};
    arguments.insert(arguments.end(), variant.begin(), variant.end());
    EXPECT_TRUE(pictures.insert(draw(arguments)).second) << variant[0] << " changed nothing";
  }
}

TEST_F(Render, SeenFromStraightAboveYIsUp) {
  const std::vector<std::string> above{"builtin:duct", "--camera-position", "0,0,9", "--camera-focal-point", "0,0,0"};
  EXPECT_EQ(draw({"builtin:sphere", "--camera-position", "0,0,5"}),
            draw({"builtin:sphere", "--camera-position", "0,0,5", "--camera-focal-point", "0,0,0", "--camera-view-up",
                  "0,1,0"}));
  std::vector<std::string> as_map = above;
  as_map.insert(as_map.end(), {"--camera-view-up", "0,1,0"});
  EXPECT_EQ(draw(above), draw(as_map));
  as_map.back() = "0,0,1";
  as_map.insert(as_map.begin(), "render");
  expect_error(run(as_map), 1, {"parallel to the line of sight"});
}

TEST_F(Render, SamePixelsForEveryThreadCountAndWithoutEarlyTermination) {
  const auto picture = draw({"builtin:duct"});
  EXPECT_EQ(draw({"builtin:duct", "--threads", "1"}), picture);
  EXPECT_EQ(draw({"builtin:duct", "--threads", "3", "--repeat", "2"}), picture);
  const auto complete = draw({"builtin:duct", "--early-ray-termination", "off"});
  ASSERT_EQ(complete.size(), picture.size());
  for (std::size_t i = 0; i < picture.size(); ++i) EXPECT_NEAR(picture[i], complete[i], 0.5 / 255.0);
}

TEST_F(Render, PngKinds) {
  EXPECT_EQ(run({"render", "builtin:sphere", "--resolution", "32,32", "--bit-depth", "16", "-o", "deep.png"}).code, 0);
  EXPECT_EQ(run({"render", "builtin:sphere", "--resolution", "32,32", "--alpha", "-o", "alpha.png"}).code, 0);
  // Bytes 24 and 25 of a PNG: bit depth and colour type.
  EXPECT_EQ(read("deep.png").substr(24, 2), std::string("\x10\x02"));
  EXPECT_EQ(read("alpha.png").substr(24, 2), std::string("\x08\x06"));
}

TEST_F(Render, FileInAnotherDirectoryGoesHere) {
  write_tetrahedron("data/one.vtk");
  const Result result = run({"render", "data/one.vtk", "--resolution", "32,32"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("wrote one.png"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("ramp (point) 0 .. 3"), std::string::npos) << result.out;
}

TEST_F(Render, NeverBlankWithoutAWord) {
  write_tetrahedron("one.vtk");
  const std::vector<std::string> start{"render", "one.vtk", "--resolution", "32,32", "-o", "a.png"};
  const auto warning = [&](std::vector<std::string> more, const std::string& part) {
    std::filesystem::remove(path("a.png"));
    more.insert(more.begin(), start.begin(), start.end());
    const Result result = run(more);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_TRUE(result.err.starts_with("tetravox: warning: ")) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_TRUE(std::filesystem::exists(path("a.png")));
  };
  warning({"--camera-position", "5,5,5", "--camera-focal-point", "9,9,9"}, "camera does not see the data");
  warning({"--transfer-function", "viridis:linear", "--range", "10,20"}, "transparent over the data's range 0 .. 3");
  warning({"--unit-distance", "1e9"}, "too thin");
  warning({"--array", "same"}, "'same' is 5 everywhere; others to draw with --array: ramp");
}

}  // namespace
}  // namespace tetravox::cli
