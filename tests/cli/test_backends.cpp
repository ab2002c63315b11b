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
  expect_error(run({"render", "builtin:sphere", "--integrator", "table3d", "--preintegration-device", "gpu"}), 1,
               {"on the GPU", "--backend gl"});
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

TEST_F(Backends, OptionsOfOpenGlSayThatTheyChangeNothingElsewhere) {
  const Result result = run({"render", "builtin:sphere", "--entry-order", "peeling", "--resolution", "20,20"});
  EXPECT_EQ(result.code, 0);
  EXPECT_NE(result.err.find("--entry-order changes nothing"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace tetravox::cli
