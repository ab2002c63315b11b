/// `--backend gl` on the command line.

#include "tests/cli/run_tool.h"
#include "tests/common/image_compare.h"
#include "tests/common/image_file.h"

#include <nlohmann/json.hpp>

namespace tetravox::cli {
namespace {

class Backends : public ToolTest {
 protected:
  /// What `list devices` says below its title; none where nothing here draws by OpenGL.
  bool has_device() const {
    const std::string text = run({"list", "devices"}).out;
    return text.find('\n') + 1 < text.size();
  }
};

TEST_F(Backends, OpenGlDrawsTheSamePictureAndSaysSo) {
  if (!has_device()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL";
  for (const std::string backend : {"cpu", "gl"}) {
    const Result result = run({"render", "builtin:duct", "--backend", backend, "--resolution", "80,60", "--statistics",
                               backend + ".json", "-o", backend + ".npy"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(nlohmann::json::parse(read(backend + ".json")).at("backend"), backend);
  }
  const auto json = nlohmann::json::parse(read("gl.json"));
  EXPECT_FALSE(json.at("device").get<std::string>().empty());
  EXPECT_GT(json.at("segments").get<std::uint64_t>(), 0u);
  EXPECT_FALSE(nlohmann::json::parse(read("cpu.json")).contains("device"));
  EXPECT_TRUE(tests::images_agree(tests::read_picture(path("gl.npy")), tests::read_picture(path("cpu.npy")), 5e-4));
}

TEST_F(Backends, EntriesGoByListsOrPeeling) {
  if (!has_device()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL";
  for (const std::string order : {"lists", "peeling"}) {
    const Result result = run({"render", "builtin:buckyball", "--backend", "gl", "--entry-order", order, "--resolution",
                               "60,50", "-o", order + ".npy"});
    ASSERT_EQ(result.code, 0) << result.err;
  }
  EXPECT_TRUE(
      tests::images_agree(tests::read_picture(path("lists.npy")), tests::read_picture(path("peeling.npy")), 1e-5));
}

TEST_F(Backends, WhatItCannotDrawIsRefusedByName) {
  if (!has_device()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL";
  expect_error(run({"render", "builtin:sphere", "--backend", "gl", "--lights", "headlight"}), 1,
               {"light", "--backend cpu"});
  expect_error(run({"render", "builtin:sphere", "--backend", "gl", "--gl-device", "30"}), 1, {"no device 30"});
  EXPECT_TRUE(names().empty());
}

TEST_F(Backends, TablesAreMadeOnTheDeviceOrByTheCpu) {
  expect_error(run({"render", "builtin:sphere", "--backend", "cpu", "--integrator", "polynomial=2",
                    "--preintegration-device", "gpu"}),
               1, {"on the GPU", "--backend gl"});
  EXPECT_TRUE(names().empty());
  if (!has_device()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL";
  for (const std::string device : {"cpu", "gpu"}) {
    const Result result =
        run({"render", "builtin:duct", "--backend", "gl", "--integrator", "table3d", "--preintegration-size", "64,32",
             "--preintegration-device", device, "--resolution", "80,60", "-o", device + ".npy"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
  }
  EXPECT_TRUE(tests::images_agree(tests::read_picture(path("gpu.npy")), tests::read_picture(path("cpu.npy")), 2e-5));
}

TEST_F(Backends, WhatOpenGlAloneHasNeedsNoOption) {
  if (!has_device()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL";
  const std::vector<std::vector<std::string>> cases = {
      {"builtin:sphere", "--source", "project"},
      {"builtin:sphere", "--source", "vicp"},
      {"builtin:hydrogen", "--source", "slices=view-3d"},
      {"builtin:sphere", "--integrator", "polynomial=2", "--preintegration-device", "gpu"}};
  for (const std::vector<std::string>& options : cases) {
    std::vector<std::string> first{"render", "--resolution", "60,50", "-o", "first.png"};
    first.insert(first.end(), options.begin(), options.end());
    const Result drawn = run(first);
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_EQ(drawn.err, "");
    // A picture carries its scene, whatever has drawn it.
    const Result again = run({"render", "first.png", "-o", "again.png", "--statistics", "again.json"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(nlohmann::json::parse(read("again.json")).at("backend"), "gl");
    EXPECT_EQ(read("again.png"), read("first.png")) << options[2];
  }
  // Options are of the backend that draws.
  const std::vector<std::string> projected{"render",       "first.png", "--source", "project",
                                           "--resolution", "20,20",     "-o",       "more.png"};
  const auto warned = [&](std::vector<std::string> more) {
    more.insert(more.begin(), projected.begin(), projected.end());
    const Result result = run(more);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.err.find("changes nothing") != std::string::npos;
  };
  EXPECT_FALSE(warned({"--gl-device", "0"}));
  EXPECT_TRUE(warned({"--instruction-set", "SCALAR"}));
}

TEST_F(Backends, ConstantCellsNeedNoTablesAndStayWithTheCpu) {
  const Result drawn = run({"render", "builtin:hydrogen", "--filter", "nearest", "--integrator", "table3d",
                            "--preintegration-device", "gpu", "--clip-plane", "0,0,0,1,0,0", "--resolution", "20,20",
                            "--statistics", "drawn.json", "-o", "drawn.png"});
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_EQ(nlohmann::json::parse(read("drawn.json")).at("backend"), "cpu");
}

TEST_F(Backends, OptionsOfOpenGlSayThatTheyChangeNothingElsewhere) {
  const Result result =
      run({"render", "builtin:sphere", "--entry-order", "peeling", "--gl-device", "0", "--resolution", "20,20"});
  EXPECT_EQ(result.code, 0);
  for (const char* option : {"--entry-order", "--gl-device"})
    EXPECT_NE(result.err.find(std::string(option) + " changes nothing"), std::string::npos) << result.err;
}

TEST_F(Backends, OptionsThatChangeNothingThereAreSaid) {
  if (!has_device()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL";
  ASSERT_EQ(run({"render", "builtin:sphere", "--resolution", "8,8", "--statistics", "s.json"}).code, 0);
  const auto instruction_set = nlohmann::json::parse(read("s.json")).at("isa").get<std::string>();
  struct Case {
    std::vector<std::string> arguments;  ///< the last but one is the option that is looked at
    bool is_used = false;
  };
  const std::vector<std::string> mesh{"builtin:sphere"}, grid{"builtin:hydrogen?size=12"};
  const std::vector<Case> on_meshes = {
      {{"--instruction-set", instruction_set}},
      {{"--entry-order", "peeling"}, true},
      {{"--source", "project", "--entry-order", "peeling"}},
      {{"--source", "project", "--early-ray-termination", "off"}},
      {{"--source", "vicp", "--sort", "exact", "--early-ray-termination", "off"}, true},
      {{"--mesh-transfer", "cells"}},
      {{"--source", "vicp", "--mesh-transfer", "cells"}, true},
      {{"--source", "project", "--mesh-transfer", "cells"}, true},
      {{"--source", "vicp", "--decomposition", "gpu"}},
      {{"--integrator", "table3d", "--preintegration-device", "gpu", "--preintegration-incremental", "off"}},
  };
  const std::vector<Case> on_grids = {
      {{"--entry-order", "peeling"}},
      {{"--source", "slices", "--early-ray-termination", "off"}},
      {{"--source", "slices", "--slabs", "linear"}, true},
      {{"--source", "slices", "--classification", "post", "--slabs", "linear"}},
      {{"--source", "slices", "--classification", "post", "--samples", "4"}},
      {{"--source", "slices", "--slices-per-voxel", "1"}, true},
      {{"--source", "slices", "--slices", "20", "--slices-per-voxel", "1"}},
      {{"--source", "slices=object-2d", "--slices-per-voxel", "1"}},
      {{"--source", "slices=object-2d", "--slices", "20"}},
      {{"--source", "slices=object-2d-interpolated", "--slices", "20"}, true},
      {{"--source", "slices", "--integrator", "partial", "--tolerance", "0.1"}},
      {{"--source", "slices", "--tolerance", "0.1"}, true},
  };
  const auto check = [&](const std::vector<std::string>& input, const Case& tried) {
    std::vector<std::string> arguments{"render", "--backend", "gl", "--resolution", "8,8", "-o", "a.npy"};
    arguments.insert(arguments.end(), input.begin(), input.end());
    arguments.insert(arguments.end(), tried.arguments.begin(), tried.arguments.end());
    const Result result = run(arguments);
    const std::string option = tried.arguments[tried.arguments.size() - 2];
    EXPECT_EQ(result.code, 0) << result.err;
    if (tried.is_used)
      EXPECT_EQ(result.err, "") << option;
    else
      EXPECT_NE(result.err.find(option + " changes nothing: "), std::string::npos) << option << ": " << result.err;
  };
  for (const Case& tried : on_meshes) check(mesh, tried);
  for (const Case& tried : on_grids) check(grid, tried);
}

TEST_F(Backends, RefusalsNameWhatHelps) {
  const std::vector<std::string> plain{"--resolution", "8,8", "-o", "a.npy"};
  const auto draw = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), plain.begin(), plain.end());
    return run(arguments);
  };
  for (const std::string source : {"project", "vicp"})
    expect_error(draw({"builtin:sphere", "--backend", "cpu", "--source", source}), 1,
                 {"'" + source + "'", "--backend gl", "'walk'"});
  expect_error(draw({"builtin:hydrogen", "--backend", "cpu", "--source", "slices"}), 1,
               {"'slices'", "--backend gl", "'march'"});
  expect_error(draw({"builtin:hydrogen", "--shadows", "half-angle"}), 1, {"'slices'", "--backend gl"});
  if (!has_device()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL";
  expect_error(draw({"builtin:sphere", "--backend", "gl", "--isosurface", "0.5"}), 1,
               {"iso-surfaces", "--backend cpu"});
  expect_error(draw({"builtin:sphere", "--backend", "gl", "--source", "vicp", "--shade"}), 1,
               {"light", "--backend cpu --source walk"});
  const std::vector<std::string> slices{"builtin:hydrogen", "--backend", "gl", "--source", "slices"};
  const auto slice = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), slices.begin(), slices.end());
    return draw(arguments);
  };
  expect_error(slice({"--samples-per-voxel", "2"}), 1, {"fixed rate", "--slices-per-voxel"});
  expect_error(slice({"--clip-plane", "0,0,0,1,0,0"}), 1, {"clipping", "--backend cpu --source march"});
  expect_error(slice({"--shade", "--shadows", "volume"}), 1, {"these shadows", "half-angle"});
  // What is named helps.
  EXPECT_EQ(draw({"builtin:hydrogen", "--backend", "cpu", "--source", "march", "--clip-plane", "0,0,0,1,0,0"}).code, 0);
  EXPECT_EQ(draw({"builtin:sphere", "--backend", "gl", "--source", "vicp"}).code, 0);
}

}  // namespace
}  // namespace tetravox::cli
