#include "tests/cli/run_tool.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstring>
#include <filesystem>

namespace tetravox::cli {
namespace {

/// Functions of several variables, and colours by another array, between command line, scene and picture.
class Multidimensional : public ToolTest {
 protected:
  /// Draws a small picture and returns its bytes; expects no error.
  std::string draw(const std::string& output, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"--resolution", "32,32", "-o", output});
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return read(output);
  }
  nlohmann::json scene(const std::string& name) const { return nlohmann::json::parse(read(name)); }
  /// A table of uint8 with `height` x `width` entries: opaque to the right, red below and blue above.
  void write_table(const std::string& name, std::size_t width, std::size_t height) const {
    std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (" + std::to_string(height) + ", " +
                         std::to_string(width) + ", 4), }\n";
    std::string text = std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size()) + '\0' + header;
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        text += static_cast<char>(255 - 255 * y / (height - 1));
        text += '\0';
        text += static_cast<char>(255 * y / (height - 1));
        text += static_cast<char>(64 * x / (width - 1));
      }
    write(name, text);
  }
};

const std::string kDuct = "builtin:duct?cells=2000";
const std::string kAtom = "builtin:hydrogen?size=20&type=float32";

TEST_F(Multidimensional, OneOptionDrawsByGradients) {
  for (const std::string& input : {kDuct, kAtom}) {
    const std::string plain = draw("a.npy", {input});
    const std::string first = draw("b.npy", {input, "--variables", "gradient", "--save-scene", "b.json"});
    EXPECT_NE(first, plain);
    const nlohmann::json saved = scene("b.json");
    EXPECT_FALSE(saved.contains("transfer_function"));
    EXPECT_EQ(saved["multidimensional"]["variables"][1]["kind"], "gradient");
    EXPECT_TRUE(saved["multidimensional"]["variables"][1].contains("range"));
    EXPECT_EQ(draw("c.npy", {"b.json", "--threads", "1"}), first);
    EXPECT_NE(draw("d.npy", {"b.json", "--variables", "none"}), first);
    EXPECT_NE(draw("e.npy", {"b.json", "--unit-distance", "0.001"}), first);
  }
}

TEST_F(Multidimensional, WidgetsAreDrawnAndKept) {
  const std::vector<std::string> widgets{"--array",     "pressure",
                                         "--variables", "array:speed=0..2",
                                         "--widget",    "rectangle:0,1:1,0.5:1,0,0:0.3",
                                         "--widget",    "triangle:0,1:1,0.5:0,0,1",
                                         "--widget",    "gaussian:0,0.5:0.3,0.3"};
  std::vector<std::string> arguments = widgets;
  arguments.insert(arguments.begin(), kDuct);
  arguments.insert(arguments.end(), {"--save-scene", "a.json", "--table-resolution", "40"});
  const std::string first = draw("a.npy", arguments);
  const nlohmann::json function = scene("a.json")["multidimensional"];
  ASSERT_EQ(function["widgets"].size(), 3u);
  EXPECT_EQ(function["widgets"][0]["shape"], "rectangle");
  EXPECT_EQ(function["widgets"][1]["opacity"], 0.5);
  EXPECT_EQ(function["resolution"], 40);
  EXPECT_EQ(function["variables"][1]["array"], "speed");
  EXPECT_EQ(function["variables"][1]["range"], (nlohmann::json{0.0, 2.0}));
  EXPECT_EQ(draw("b.npy", {"a.json"}), first);
  EXPECT_NE(draw("c.npy", {"a.json", "--widget", "gaussian:0,0.5:0.3,0.3"}), first);
}

TEST_F(Multidimensional, ThreeVariables) {
  const std::vector<std::string> variables{kAtom, "--variables", "gradient,array:wave", "--save-scene", "a.json"};
  const std::string first = draw("a.npy", variables);
  EXPECT_EQ(scene("a.json")["multidimensional"]["variables"].size(), 3u);
  EXPECT_EQ(draw("b.npy", {"a.json"}), first);
}

TEST_F(Multidimensional, TablesLieBesideTheScene) {
  write_table("table.npy", 8, 4);
  std::filesystem::create_directory(path("scenes"));
  const std::string first =
      draw("a.npy", {kAtom, "--variables", "array:wave", "--table", "table.npy", "--save-scene", "scenes/a.json"});
  EXPECT_EQ(scene("scenes/a.json")["multidimensional"]["table"], "../table.npy");
  EXPECT_EQ(draw("b.npy", {"scenes/a.json"}), first);
  write_table("table.npy", 8, 5);
  EXPECT_NE(draw("c.npy", {"scenes/a.json", "--table-resolution", "64"}), first);
  write("table.npy", "nothing");
  expect_error(run({"render", "scenes/a.json"}), 1, {"table.npy", "damaged"});
}

TEST_F(Multidimensional, ColorsFollowAnotherArray) {
  for (const auto& [input, array] : {std::pair(kDuct, "speed"), std::pair(kAtom, "wave")}) {
    const std::string plain = draw("a.npy", {input});
    const std::string first = draw("b.npy", {input, "--color-array", array, "--save-scene", "b.json"});
    EXPECT_NE(first, plain);
    EXPECT_EQ(scene("b.json")["color_by"]["array"], array);
    EXPECT_TRUE(scene("b.json")["color_by"].contains("function"));
    EXPECT_TRUE(scene("b.json").contains("transfer_function"));
    EXPECT_EQ(draw("c.npy", {"b.json"}), first);
    EXPECT_NE(draw("c.npy", {"b.json", "--color-function", "coolwarm"}), first);
    EXPECT_NE(draw("c.npy", {"b.json", "--color-range", "0.4,0.5"}), first);
    EXPECT_EQ(draw("c.npy", {"b.json", "--color-array", "none"}), plain);
    EXPECT_EQ(draw("c.npy", {"b.json", "--variables", "none"}), first);
  }
}

TEST_F(Multidimensional, ComponentsOfOneArray) {
  std::string bytes;
  for (int i = 0; i < 512; ++i) bytes += {static_cast<char>(i % 8), static_cast<char>(i / 64)};
  write("two_8x8x8_uint8.raw", bytes);
  const std::vector<std::string> base{"two_8x8x8_uint8.raw", "--components", "2", "--component", "0"};
  std::vector<std::string> by_other = base, by_both = base;
  by_other.insert(by_other.end(), {"--color-array", "values:1"});
  by_both.insert(by_both.end(), {"--variables", "array:values:1", "--save-scene", "a.json"});
  EXPECT_NE(draw("b.npy", by_other), draw("a.npy", base));
  const std::string first = draw("c.npy", by_both);
  EXPECT_EQ(scene("a.json")["multidimensional"]["variables"][1]["component"], 1);
  EXPECT_EQ(draw("d.npy", {"a.json"}), first);
}

TEST_F(Multidimensional, WhatDoesNotGoTogetherIsRefused) {
  const auto refuse = [&](std::vector<std::string> arguments, int code, const std::vector<std::string>& parts) {
    arguments.insert(arguments.begin(), {"render", kDuct, "--array", "pressure"});
    arguments.insert(arguments.end(), {"--resolution", "8,8", "-o", "a.png"});
    expect_error(run(arguments), code, parts);
  };
  const std::string widget = "gaussian:0,0:1,1";
  refuse({"--variables", "slope"}, 2, {"--variables", "'slope'", "gradient"});
  refuse({"--variables", "value"}, 2, {"--variables", "first variable already"});
  refuse({"--variables", "array"}, 2, {"array:NAME"});
  refuse({"--variables", "array:"}, 2, {"--variables", "name of an array"});
  refuse({"--variables", "gradient,gradient"}, 2, {"--variables", "same"});
  refuse({"--variables", "gradient,array:a,array:b"}, 2, {"more than two"});
  refuse({"--variables", "gradient=1"}, 2, {"'1'", "a..b"});
  refuse({"--variables", "gradient=2..1"}, 2, {"--variables", "2,1"});
  refuse({"--variables", "array:heat"}, 1, {"no array 'heat'", "'speed' (point)"});
  refuse({"--variables", "array:volume"}, 1, {"'pressure' (point)", "'volume' (cell)"});
  refuse({"--widget", widget}, 2, {"--variables"});
  refuse({"--table-resolution", "64"}, 2, {"--variables"});
  refuse({"--variables", "gradient", "--widget", "gaussian:0,0,0:1,1,1"}, 2, {"3 numbers", "2 variables"});
  refuse({"--variables", "gradient", "--widget", "disc:0,0:1,1"}, 2, {"--widget", "'disc'", "triangle"});
  refuse({"--variables", "gradient", "--widget", "gaussian:0,0:1"}, 2, {"--widget", "2 numbers"});
  refuse({"--variables", "gradient", "--widget", "gaussian"}, 2, {"--widget", "SHAPE:x,y"});
  refuse({"--variables", "gradient", "--widget", "gaussian:0,0:1,0"}, 2, {"radius"});
  refuse({"--variables", "gradient", "--widget", widget + ":1,1,1:2"}, 2, {"opacity"});
  refuse({"--variables", "gradient", "--widget", widget, "--table", "t.npy"}, 2, {"--widget or --table"});
  refuse({"--variables", "gradient,array:speed", "--table-resolution", "200"}, 2, {"resolution", "128"});
  refuse({"--variables", "gradient", "--table", "t.npy"}, 1, {"t.npy"});
  refuse({"--variables", "gradient", "--transfer-function", "viridis"}, 2, {"--transfer-function", "--variables"});
  refuse({"--variables", "gradient", "--log"}, 2, {"--log"});
  refuse({"--variables", "gradient", "--color-array", "speed"}, 2, {"--color-array", "of its own"});
  refuse({"--color-function", "viridis"}, 2, {"--color-array"});
  refuse({"--color-range", "0,1"}, 2, {"--color-array"});
  refuse({"--color-array", "heat"}, 1, {"no array 'heat'"});
  refuse({"--color-array", "speed", "--color-function", "viridid"}, 1, {"viridid"});
  refuse({"--color-array", "speed:2"}, 1, {"component 2"});
  EXPECT_TRUE(names().empty());
}

TEST_F(Multidimensional, AnEmptyPictureSaysWhy) {
  const Result result = run({"render", kAtom, "--variables", "gradient", "--widget", "rectangle:5,5:1,1",
                             "--resolution", "8,8", "-o", "a.png"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("the picture is empty: nothing that is opaque by the widgets"), std::string::npos)
      << result.err;
}

TEST_F(Multidimensional, StatisticsNameWhatIntegrates) {
  draw("a.npy", {kAtom, "--variables", "gradient", "--statistics", "a.json"});
  EXPECT_EQ(scene("a.json")["integrator"], "domain");
  draw("a.npy", {kAtom, "--statistics", "a.json"});
  EXPECT_EQ(scene("a.json")["integrator"], "antiderivative");
}

TEST_F(Multidimensional, AJointHistogram) {
  ASSERT_EQ(run({"histogram", kDuct, "--kind", "joint", "--array", "pressure", "--other-array", "speed"}).code, 0);
  EXPECT_GT(read("duct-histogram.png").size(), 1000u);
  const Result table = run({"histogram", kAtom, "--kind", "joint", "--other-array", "wave", "-o", "a.npy", "--bins",
                            "6", "--other-bins", "5", "--other-range", "0,1"});
  ASSERT_EQ(table.code, 0) << table.err;
  EXPECT_NE(table.out.find("other 0 .. 1 in 5 bins"), std::string::npos) << table.out;
  EXPECT_NE(read("a.npy").find("'shape': (5, 6)"), std::string::npos);
  ASSERT_EQ(run({"histogram", kAtom, "--kind", "joint", "--other-array", "wave", "-o", "a.csv"}).code, 0);
  EXPECT_EQ(read("a.csv").substr(0, 46), "value_from,value_to,other_from,other_to,share\n");
  expect_error(run({"histogram", kDuct, "--kind", "joint"}), 2, {"--other-array"});
  expect_error(run({"histogram", kDuct, "--other-array", "speed"}), 2, {"--kind joint"});
}

}  // namespace
}  // namespace tetravox::cli
