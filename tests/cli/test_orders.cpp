#include "tests/cli/run_tool.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace tetravox::cli {
namespace {

/// The command `order`.
class Orders : public ToolTest {
 protected:
  std::vector<std::uint32_t> cells_of(const std::string& name) const {
    std::istringstream lines(read(name));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "cell");
    std::vector<std::uint32_t> cells;
    while (std::getline(lines, line)) cells.push_back(static_cast<std::uint32_t>(std::stoul(line)));
    return cells;
  }
};

TEST_F(Orders, TheExactOneByDefault) {
  const Result result = run({"order", "builtin:duct?cells=5000", "--check"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* part : {"xmpvo: ", " cells/s", "gaps: ", "cycles: 0 of 0 cells", "faces: 0 of ", "rays: 0 of "})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " in " << result.out;
  EXPECT_TRUE(names().empty());
}

TEST_F(Orders, FilesAndStatistics) {
  const std::vector<std::string> view = {"order", "builtin:sphere", "--camera-azimuth", "25"};
  const auto with = [&view](const std::vector<std::string>& more) {
    std::vector<std::string> all = view;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  ASSERT_EQ(run(with({"-o", "a.csv", "--statistics", "a.json", "--check", "--resolution", "20,30"})).code, 0);
  const std::vector<std::uint32_t> back = cells_of("a.csv");
  EXPECT_EQ(back.size(), 2560u);
  EXPECT_EQ(std::set<std::uint32_t>(back.begin(), back.end()).size(), 2560u);
  const auto json = nlohmann::json::parse(read("a.json"));
  EXPECT_EQ(json.at("method"), "xmpvo");
  EXPECT_EQ(json.at("cells"), 2560);
  EXPECT_GT(json.at("cells_per_second").get<double>(), 0.0);
  EXPECT_EQ(json.at("check").at("face_violations"), 0);
  EXPECT_EQ(json.at("check").at("wrong_segments"), 0);
  EXPECT_LE(json.at("check").at("rays").get<int>(), 600);
  ASSERT_EQ(run(with({"-o", "b.csv", "--direction", "front-to-back"})).code, 0);
  const std::vector<std::uint32_t> front = cells_of("b.csv");
  EXPECT_EQ(std::vector<std::uint32_t>(front.rbegin(), front.rend()), back);
  ASSERT_EQ(run(with({"-o", "a.npy", "--sort", "centroid"})).code, 0);
  EXPECT_EQ(read("a.npy").substr(1, 5), "NUMPY");
  EXPECT_EQ(names(), (std::vector<std::string>{"a.csv", "a.json", "a.npy", "b.csv"}));
}

TEST_F(Orders, CentroidsErrAndAreCounted) {
  const Result result = run({"order", "builtin:duct?cells=5000", "--check", "--sort", "centroid", "--threads", "1"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("centroid: "), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("faces: 0 of"), std::string::npos) << result.out;
}

TEST_F(Orders, Mistakes) {
  expect_error(run({"order"}), 2, {"name what to read"});
  expect_error(run({"order", "builtin:sphere", "--sort", "quick"}), 2, {"--sort", "quick", "centroid, mpvo"});
  expect_error(run({"order", "builtin:sphere", "-o", "a.png"}), 2, {"--output", ".npy or .csv"});
  expect_error(run({"order", "builtin:sphere", "--resolution", "4,4"}), 2, {"--resolution", "--check"});
  expect_error(run({"order", "builtin:sphere", "-o", "a.csv", "--statistics", "a.csv"}), 2, {"names of their own"});
  expect_error(run({"order", "builtin:hydrogen"}), 1, {"builtin:hydrogen", "is a grid"});
  expect_error(run({"order", "builtin:sphere", "-o", "nowhere/a.csv"}), 1, {"nowhere"});
  expect_error(run({"order", "builtin:sphere", "--camera-view-angle", "20", "--camera-parallel-scale", "2"}), 2,
               {"not both"});
}

}  // namespace
}  // namespace tetravox::cli
