#include "tests/cli/run_tool.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace tetravox::cli {
namespace {

class Listing : public ToolTest {
 protected:
  void expect_text(const std::vector<std::string>& arguments, const std::vector<std::string>& parts) const {
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    for (const std::string& part : parts)
      EXPECT_NE(result.out.find(part), std::string::npos) << part << " in " << result.out;
  }
};

TEST_F(Listing, HelpAndVersion) {
  expect_text({"--help"}, {"render", "info", "histogram", "list", "Examples:"});
  expect_text({"render", "--help"}, {"--transfer-function", "--range", "--camera-position", "--early-ray-termination",
                                     "--time", "a whole number is an index", "Examples:", "--statistics"});
  expect_text({"info", "--help"}, {"--json", "--time"});
  expect_text({"histogram", "--help"}, {"--kind", "--counts", "--bins", "--gradient-range", "--time", "Examples:"});
  expect_text({"order", "--help"},
              {"--sort", "--check", "--camera-position", "--direction", "--statistics", "Examples:"});
  expect_text({"list", "--help"}, {"presets"});
  expect_text({"--version"}, {"tetravox 0."});
}

TEST_F(Listing, Topics) {
  expect_text({"list", "presets"}, {"viridis", "coolwarm", "peaks", "random", "auto:boundaries"});
  expect_text({"list", "readers"}, {"VTU", ".png", ".exr", ".npy"});
  expect_text({"list", "builtins"}, {"builtin:sphere", "builtin:buckyball", "builtin:duct"});
  expect_text({"list", "devices"}, {"Devices for --backend gl"});
  expect_text({"list", "environments"}, {"builtin:studio", "builtin:sky", "builtin:room"});
  expect_text({"list", "sorts"},
              {"centroid", "mpvo", "mpvonc", "xmpvo", "Williams 1992", "Silva, Mitchell, Williams 1998"});
  expect_text({"list", "methods"}, {"walk",
                                    "antiderivative",
                                    "partial",
                                    "post",
                                    "table3d",
                                    "polynomial=N",
                                    "cylindrical",
                                    "2000)",
                                    "Gradients (--gradient)",
                                    "central",
                                    "Shadows (--shadows)",
                                    "exact",
                                    "Opacity weights (--opacity-weight)",
                                    "scalar-difference",
                                    "Instruction sets",
                                    "Where projected cells become triangles (--decomposition)",
                                    "a compute shader",
                                    "What of the mesh is sent for a frame (--mesh-transfer)",
                                    "Espinha and Celes 2005",
                                    "Wittenbrink",
                                    "Williams 1992",
                                    "Carpenter 1984",
                                    "Behrens and Ratering 1998"});
  expect_error(run({"list"}), 2, {"list what?", "methods", "sorts or devices"});
}

TEST_F(Listing, InfoOfAFile) {
  write_tetrahedron("one.vtk");
  expect_text({"info", "one.vtk"}, {"one.vtk", "1 tetrahedron", "points    4", "x 0 .. 1", "ramp *  point", "0 .. 3",
                                    "same  point", "5 .. 5", "memory", "are free"});
}

TEST_F(Listing, InfoAsJson) {
  for (const std::string name : {"builtin:sphere", "builtin:duct"}) {
    const Result result = run({"info", name, "--json"});
    ASSERT_EQ(result.code, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json.at("source"), name);
    EXPECT_GT(json.at("cells").get<std::uint64_t>(), 0u);
    EXPECT_EQ(json.at("bounds").size(), 3u);
    EXPECT_GE(json.at("arrays").size(), 1u);
    EXPECT_GT(json.at("bytes").at("mesh").get<std::uint64_t>(), 0u);
    std::uint64_t total = 0;
    for (const auto& [type, count] : json.at("cells_by_type").items()) total += count.get<std::uint64_t>();
    EXPECT_EQ(total, json.at("cells").get<std::uint64_t>());
  }
}

TEST_F(Listing, InfoOfASceneAndAPicture) {
  ASSERT_EQ(run({"render", "builtin:sphere", "--resolution", "8,8", "--save-scene", "s.json"}).code, 0);
  expect_text({"info", "s.json"}, {"builtin:sphere", "2,560 tetrahedra"});
  expect_text({"info", "sphere.png"}, {"builtin:sphere", "2,560 tetrahedra"});
}

}  // namespace
}  // namespace tetravox::cli
