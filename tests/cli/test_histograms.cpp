#include "tests/cli/run_tool.h"

#include <cmath>
#include <cstring>
#include <sstream>

namespace tetravox::cli {
namespace {

/// The command `histogram`, and the function that is made from derivatives.
class Histograms : public ToolTest {
 protected:
  /// Numbers of the last column of a table.
  std::vector<double> last_column(const std::string& name) const {
    std::istringstream lines(read(name));
    std::string line;
    std::getline(lines, line);
    std::vector<double> numbers;
    while (std::getline(lines, line)) numbers.push_back(std::stod(line.substr(line.rfind(',') + 1)));
    return numbers;
  }
};

TEST_F(Histograms, APictureByDefault) {
  const Result result = run({"histogram", "builtin:sphere"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(names(), (std::vector<std::string>{"sphere-histogram.png"}));
  for (const char* part : {"wrote sphere-histogram.png", "value 0 .. 1 in 256 bins", "largest bin"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " in " << result.out;
  ASSERT_EQ(run({"histogram", "builtin:sphere", "--counts", "log", "-o", "log.png"}).code, 0);
  EXPECT_NE(read("log.png"), read("sphere-histogram.png"));
}

TEST_F(Histograms, ATableOfATetrahedron) {
  write_tetrahedron("one.vtk");
  const Result result = run({"histogram", "one.vtk", "-o", "one.csv", "--bins", "3"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(read("one.csv").substr(0, 26), "value_from,value_to,share\n");
  // Values 0 to 3 at the corners: a sixth lies in the first third and in the last.
  const std::vector<double> shares = last_column("one.csv");
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_NEAR(shares[0], 1.0 / 6.0, 1e-6);
  EXPECT_NEAR(shares[1], 2.0 / 3.0, 1e-6);
  EXPECT_NEAR(shares[2], 1.0 / 6.0, 1e-6);
}

TEST_F(Histograms, AGridCountsItsWholeNumbers) {
  std::string bytes;
  for (char value = 0; value < 24; ++value) bytes += static_cast<char>(value / 2);
  write("a_4x3x2_uint8.raw", bytes);
  const Result result = run({"histogram", "a_4x3x2_uint8.raw", "-o", "a.csv"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("in 12 bins"), std::string::npos) << result.out;
  for (const double share : last_column("a.csv")) EXPECT_GT(share, 0.0);
}

TEST_F(Histograms, GradientsAsAnArray) {
  const Result result = run({"histogram", "builtin:sphere", "--kind", "gradient", "-o", "a.npy", "--bins", "20",
                             "--gradient-bins", "10", "--gradient-range", "0,4"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("gradient 0 .. 4 in 10 bins"), std::string::npos) << result.out;
  const std::string array = read("a.npy");
  EXPECT_NE(array.find("'shape': (10, 20)"), std::string::npos);
  std::vector<double> shares(200);
  ASSERT_GT(array.size(), 1600u);
  std::memcpy(shares.data(), array.data() + array.size() - 1600, 1600);
  double total = 0.0;
  for (const double share : shares) total += share;
  EXPECT_NEAR(total, 1.0, 1e-6);
}

TEST_F(Histograms, TwoDimensionsAsAPictureAndATable) {
  for (const std::string name : {"builtin:duct?cells=2000", "builtin:hydrogen"}) {
    ASSERT_EQ(run({"histogram", name, "--kind", "gradient", "-o", "a.png"}).code, 0);
    EXPECT_GT(read("a.png").size(), 2000u);
    ASSERT_EQ(run({"histogram", name, "--kind", "gradient", "-o", "a.csv", "--bins", "8", "--gradient-bins", "4"}).code,
              0);
    EXPECT_EQ(last_column("a.csv").size(), 32u);
  }
}

TEST_F(Histograms, WrongOptions) {
  expect_error(run({"histogram"}), 2, {"name what to read"});
  expect_error(run({"histogram", "builtin:sphere", "--bins", "0"}), 2, {"--bins"});
  expect_error(run({"histogram", "builtin:sphere", "--kind", "both"}), 2, {"--kind", "value, gradient, joint"});
  expect_error(run({"histogram", "builtin:sphere", "-o", "a.exr"}), 2, {"a.exr", ".csv"});
  expect_error(run({"histogram", "builtin:sphere", "--gradient-bins", "4"}), 2, {"--kind gradient or joint"});
  expect_error(run({"histogram", "builtin:sphere", "-o", "a.csv", "--counts", "log"}), 2, {"--counts"});
  expect_error(run({"histogram", "builtin:sphere", "-o", "no/a.csv"}), 1, {"no/a.csv"});
  expect_error(run({"histogram", "absent.vtu"}), 1, {"absent.vtu"});
  expect_error(run({"histogramm", "builtin:sphere"}), 2, {"did you mean histogram"});
  EXPECT_TRUE(names().empty());
}

TEST_F(Histograms, BoundariesAreAFunction) {
  for (const std::string name : {"builtin:buckyball?cells=20000", "builtin:hydrogen"}) {
    const Result result = run({"render", name, "--resolution", "64,64", "-o", "a.png", "--save-scene", "a.json",
                               "--transfer-function", "auto:boundaries=0.5"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    ASSERT_EQ(run({"render", "a.json", "-o", "b.png"}).code, 0);
    EXPECT_EQ(read("a.png"), read("b.png"));
  }
  const auto draw = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "builtin:sphere", "--resolution", "8,8", "-o", "c.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  expect_error(draw({"--transfer-function", "auto:edges"}), 2, {"auto:edges", "auto:boundaries"});
  expect_error(draw({"--transfer-function", "auto:boundaries=x"}), 2, {"auto:boundaries", "'x'"});
  expect_error(draw({"--transfer-function", "auto:boundaries=90"}), 1, {"0.05"});
  expect_error(draw({"--transfer-function", "auto:boundaries", "--log"}), 2, {"--log"});
  EXPECT_EQ(draw({"--transfer-function", "auto:boundaries", "--invert", "--range", "0.2,0.8"}).code, 0);
}

}  // namespace
}  // namespace tetravox::cli
