#include "tests/cli/run_tool.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace tetravox::cli {
namespace {

/// The commands on regular grids.
class Grids : public ToolTest {
 protected:
  Result draw(const std::string& output, std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", "builtin:hydrogen", "--resolution", "48,48", "-o", output});
    return run(more);
  }
  /// A raw file of 4 x 3 x 2 bytes that count up, after `header` bytes.
  void write_raw(const std::string& name, std::size_t header = 0) const {
    std::string bytes(header, '?');
    for (char value = 0; value < 24; ++value) bytes += value;
    write(name, bytes);
  }
};

TEST_F(Grids, EachBuiltinWithoutOptions) {
  for (const std::string name : {"hydrogen", "marschner-lobb", "turbulence"}) {
    const Result result = run({"render", "builtin:" + name + "?size=32"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_GT(read(name + ".png").size(), 4000u) << "that is an empty picture";
  }
}

TEST_F(Grids, StatisticsHaveTheirKeys) {
  ASSERT_EQ(draw("a.npy", {"--statistics", "s.json"}).code, 0);
  const auto json = nlohmann::json::parse(read("s.json"));
  EXPECT_EQ(json.at("kind"), "grid");
  EXPECT_EQ(json.at("source"), "march");
  EXPECT_EQ(json.at("filter"), "linear");
  EXPECT_EQ(json.at("dimensions"), (nlohmann::json{16, 16, 16}));
  EXPECT_GT(json.at("segments").get<std::uint64_t>(), 0u);
  EXPECT_GE(json.at("bytes").at("grid").get<std::uint64_t>(), 4096u);
  EXPECT_EQ(json.at("prepare").at("values"), 4096);
  EXPECT_EQ(json.at("prepare").at("bricks"), 8);
  EXPECT_EQ(json.at("prepare").at("type"), "uint8");
}

TEST_F(Grids, InfoTellsOfTheLattice) {
  const Result text = run({"info", "builtin:hydrogen"});
  ASSERT_EQ(text.code, 0) << text.err;
  for (const char* part :
       {"16 x 16 x 16 points", "spacing", "origin", "uint8", "cells     3,375", "values", "are free"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << " in " << text.out;
  const auto json = nlohmann::json::parse(run({"info", "builtin:hydrogen", "--json"}).out);
  EXPECT_EQ(json.at("kind"), "grid");
  EXPECT_EQ(json.at("grid").at("dimensions"), (nlohmann::json{16, 16, 16}));
  EXPECT_EQ(json.at("grid").at("direction").size(), 9u);
  EXPECT_TRUE(json.at("grid").at("uneven_axes").empty());
  EXPECT_EQ(json.at("bytes").at("values"), 4096);
}

TEST_F(Grids, PicturesAreDrawnAgainByteForByte) {
  const std::vector<std::vector<std::string>> variants = {{},
                                                          {"--filter", "lanczos=4"},
                                                          {"--classification", "pre"},
                                                          {"--classification", "post", "--samples-per-voxel", "2"}};
  for (const auto& variant : variants)
    for (const std::string ending : {".png", ".exr"}) {
      ASSERT_EQ(draw("a" + ending, variant).code, 0);
      const Result again = run({"render", "a" + ending, "-o", "b" + ending});
      EXPECT_EQ(again.code, 0) << again.err;
      EXPECT_EQ(read("a" + ending), read("b" + ending)) << ending;
    }
}

TEST_F(Grids, ClassificationsStandForIntegrators) {
  ASSERT_EQ(draw("a.npy", {"--classification", "post"}).code, 0);
  ASSERT_EQ(draw("b.npy", {"--integrator", "post"}).code, 0);
  EXPECT_EQ(read("a.npy"), read("b.npy"));
  ASSERT_EQ(draw("c.npy", {"--classification", "preintegrated", "--integrator", "partial"}).code, 0);
  ASSERT_EQ(draw("d.npy", {"--integrator", "partial"}).code, 0);
  EXPECT_EQ(read("c.npy"), read("d.npy"));
  expect_error(draw("e.npy", {"--classification", "pre", "--integrator", "partial"}), 2,
               {"--classification pre", "--integrator partial", "leave one out"});
  expect_error(draw("e.npy", {"--classification", "none"}), 2, {"--classification", "preintegrated"});
  // Over the scene's: pre-integration keeps the integrator where it pre-integrates, and replaces it elsewhere.
  ASSERT_EQ(draw("f.png", {"--integrator", "pre", "--save-scene", "f.json"}).code, 0);
  ASSERT_EQ(
      run({"render", "f.json", "--classification", "preintegrated", "-o", "g.png", "--save-scene", "g.json"}).code, 0);
  EXPECT_EQ(nlohmann::json::parse(read("g.json")).at("render").at("integrator"), "antiderivative");
}

TEST_F(Grids, OptionsOfTheOtherKindOfDataAreErrors) {
  const auto mesh = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "builtin:sphere", "--resolution", "16,16"});
    return run(more);
  };
  expect_error(mesh({"--filter", "nearest"}), 2, {"--filter", "is for grids", "builtin:sphere"});
  expect_error(mesh({"--samples-per-voxel", "2"}), 2, {"--samples-per-voxel", "is for grids"});
  expect_error(mesh({"--classification", "pre"}), 2, {"--classification pre", "is for grids"});
  expect_error(mesh({"--source", "march"}), 2, {"--source", "builtin:sphere"});
  expect_error(draw("a.png", {"--source", "walk"}), 2, {"--source", "builtin:hydrogen", "is a grid"});
  write("s.json", R"({"tetravox":1,"data":{"file":"builtin:sphere"},"render":{"filter":"nearest"}})");
  expect_error(run({"render", "s.json"}), 1, {"render.filter", "is for grids"});
  expect_error(draw("a.png", {"--filter", "box"}), 2, {"--filter", "catmull-rom"});
  for (const char* rate : {"65", "0", "1e-300", "abc"})
    expect_error(draw("a.png", {"--samples-per-voxel", rate}), 2, {"--samples-per-voxel", "0.001", "64", "auto"});
  EXPECT_EQ(names(), std::vector<std::string>{"s.json"});
}

TEST_F(Grids, OptionsWithoutEffectAreWarnedOf) {
  const auto expect_warning = [](const Result& result, const std::string& part) {
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.err.find("warning: " + part), std::string::npos) << result.err;
  };
  const auto mesh = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "builtin:sphere", "--resolution", "16,16"});
    return run(more);
  };
  expect_warning(mesh({"--samples", "4"}), "--samples changes nothing");
  expect_warning(mesh({"--integrator", "partial", "--tolerance", "0.1"}), "--tolerance changes nothing");
  expect_warning(draw("a.png", {"--samples", "4"}), "--samples changes nothing");
  const std::vector<std::string> fixed{"--integrator", "post", "--samples-per-voxel", "2"};
  const auto draw_fixed = [&](std::vector<std::string> more) {
    more.insert(more.begin(), fixed.begin(), fixed.end());
    return draw("a.png", more);
  };
  expect_warning(draw_fixed({"--samples", "4"}), "--samples changes nothing: --samples-per-voxel");
  expect_warning(draw_fixed({"--early-ray-termination", "off", "--tolerance", "0.1"}), "--tolerance changes nothing");
  EXPECT_EQ(draw_fixed({"--tolerance", "0.1"}).err, "") << "rays end by it";
  EXPECT_EQ(mesh({"--integrator", "post", "--samples", "4"}).err, "");
  EXPECT_EQ(mesh({"--tolerance", "0.01"}).err, "");
  EXPECT_EQ(draw("a.png", {"--tolerance", "0.01"}).err, "");
}

TEST_F(Grids, RawFilesByTheirNameOrByOptions) {
  write_raw("ramp_4x3x2_uint8.raw");
  ASSERT_EQ(run({"render", "ramp_4x3x2_uint8.raw", "--resolution", "32,32", "-o", "a.npy"}).code, 0);
  write_raw("other.raw", 5);
  const std::vector<std::string> layout{"--dimensions", "4,3,2", "--scalar-type", "uint8", "--header-bytes", "5"};
  std::vector<std::string> arguments{"render", "other.raw", "--resolution", "32,32", "-o", "b.png"};
  arguments.insert(arguments.end(), layout.begin(), layout.end());
  Result result = run(arguments);
  ASSERT_EQ(result.code, 0) << result.err;
  // The scene in the picture knows the layout.
  result = run({"render", "b.png", "-o", "c.png"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(read("b.png"), read("c.png"));
  arguments = {"info", "other.raw", "--spacing", "1,1,2.5"};
  arguments.insert(arguments.end(), layout.begin(), layout.end());
  result = run(arguments);
  EXPECT_NE(result.out.find("spacing   1, 1, 2.5"), std::string::npos) << result.out << result.err;
  expect_error(run({"info", "other.raw", "--dimensions", "4,3"}), 2, {"--dimensions"});
  expect_error(run({"info", "other.raw", "--scalar-type", "byte"}), 2, {"--scalar-type", "uint8"});
  expect_error(run({"info", "other.raw", "--spacing", "1,0,1"}), 2, {"--spacing"});
  expect_error(run({"info", "other.raw", "--components", "5"}), 2, {"--components"});
  expect_error(run({"info", "other.raw", "--header-bytes", "-1"}), 2, {"--header-bytes"});
}

TEST_F(Grids, MethodsAreListed) {
  const Result result = run({"list", "methods"});
  EXPECT_EQ(result.code, 0);
  for (const char* name : {"march", "preintegrated", "pre", "catmull-rom", "lanczos"})
    EXPECT_NE(result.out.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace tetravox::cli
