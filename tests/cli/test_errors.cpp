#include "tests/cli/run_tool.h"

#include <sys/stat.h>
#include <unistd.h>

namespace tetravox::cli {
namespace {

class Errors : public ToolTest {};

TEST_F(Errors, WrongValuesNameTheirOption) {
  const std::vector<std::vector<std::string>> wrong = {{"--range", "1,2,x"},
                                                       {"--range", "1"},
                                                       {"--range", "2,1"},
                                                       {"--range", "1,nan"},
                                                       {"--range", "1,2,3"},
                                                       {"--range", ""},
                                                       {"--resolution", "0,10"},
                                                       {"--resolution", "10"},
                                                       {"--resolution", "9,1e3"},
                                                       {"--resolution", "17000,1"},
                                                       {"--camera-position", "1,2"},
                                                       {"--camera-zoom", "0"},
                                                       {"--camera-view-angle", "x"},
                                                       {"--background", "0,0,2"},
                                                       {"--bit-depth", "12"},
                                                       {"--samples", "0"},
                                                       {"--samples", "5000"},
                                                       {"--tolerance", "-1"},
                                                       {"--threads", "-1"},
                                                       {"--repeat", "0"},
                                                       {"--time", "-1"},
                                                       {"--time", "soon"},
                                                       {"--component", "y"},
                                                       {"--association", "edge"},
                                                       {"--source", "splat"},
                                                       {"--source", "slices=4d"},
                                                       {"--slices", "0"},
                                                       {"--slices-per-voxel", "65"},
                                                       {"--integrator", "none"},
                                                       {"--integrator", "polynomial=5"},
                                                       {"--integrator", "table3d=2"},
                                                       {"--preintegration-size", "1"},
                                                       {"--preintegration-size", "9,9,9"},
                                                       {"--preintegration-lengths", "cubic"},
                                                       {"--preintegration-bits", "24"},
                                                       {"--preintegration-steps", "0"},
                                                       {"--instruction-set", "mmx"},
                                                       {"--backend", "vulkan"},
                                                       {"--gl-device", "-1"},
                                                       {"--entry-order", "random"},
                                                       {"--reader-timeout", "0"},
                                                       {"--unit-distance", "0"},
                                                       {"--early-ray-termination", "maybe"},
                                                       {"--output", "a.jpg"},
                                                       {"--preset-name", "x"}};
  for (const auto& option : wrong) {
    std::vector<std::string> arguments{"render", "builtin:sphere"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    expect_error(run(arguments), 2, {option[0], "--help"});
  }
  EXPECT_TRUE(names().empty());
}

TEST_F(Errors, UsageErrorsHelp) {
  expect_error(run({}), 2, {"name a command", "--help"});
  expect_error(run({"rendr", "x.vtu"}), 2, {"rendr", "did you mean render"});
  expect_error(run({"x.vtu"}), 2, {"tetravox render x.vtu"});
  expect_error(run({"render"}), 2, {"name what to read"});
  expect_error(run({"render", "builtin:sphere", "--integratr", "post"}), 2,
               {"--integratr", "did you mean --integrator"});
  expect_error(run({"render", "builtin:sphere", "--parallel-scale", "2"}), 2,
               {"--parallel-scale", "did you mean --camera-parallel-scale"});
  expect_error(run({"render", "builtin:sphere", "--nonsense=3"}), 2, {"--nonsense"});
  expect_error(run({"render", "builtin:sphere", "second"}), 2, {"second"});
  expect_error(run({"render", "builtin:sphere", "--range"}), 2, {"--range"});
  expect_error(run({"render", "builtin:sphere", "--quiet", "--verbose"}), 2, {"--quiet", "--verbose"});
  expect_error(run({"render", "builtin:sphere", "-o", "a.exr", "--alpha"}), 2, {"--alpha"});
  expect_error(run({"list"}), 2, {"presets, readers, builtins, methods, environments, sorts or devices"});
  expect_error(run({"list", "colours"}), 2, {"colours"});
  EXPECT_TRUE(names().empty());
}

TEST_F(Errors, FilesThatAreNotThere) {
  expect_error(run({"render", "none.vtu"}), 1, {"none.vtu"});
  expect_error(run({"info", "none.vtu"}), 1, {"none.vtu"});
  expect_error(run({"render", "none.json"}), 1, {"none.json"});
  expect_error(run({"render", "none.png", "-o", "a.png"}), 1, {"none.png"});
  expect_error(run({"render", "builtin:cube"}), 1, {"cube", "sphere"});
  expect_error(run({"render", "builtin:duct?cells=x"}), 1, {"cells"});
  expect_error(run({"render", "two\nlines.vtu"}), 1, {"lines.vtu"});
  EXPECT_TRUE(names().empty());
}

TEST_F(Errors, FilesThatAreWrong) {
  write_tetrahedron("good.vtk");
  const std::string good = read("good.vtk");
  write("cut.vtk", good.substr(0, 150));
  expect_error(run({"render", "cut.vtk"}), 1, {"cut.vtk"});
  write("a.vtu", "this is no XML");
  expect_error(run({"render", "a.vtu"}), 1, {"a.vtu"});
  write("a.unknown", "?");
  expect_error(run({"render", "a.unknown"}), 1, {"a.unknown"});
  expect_error(run({"render", "good.vtk", "--array", "pressure"}), 1, {"pressure", "ramp"});
  expect_error(run({"render", "good.vtk", "--camera-position", "0,0,0", "--camera-focal-point", "0,0,0"}), 1,
               {"camera"});
}

TEST_F(Errors, CylindricalTablesAreForMeshes) {
  expect_error(run({"render", "builtin:hydrogen", "--integrator", "cylindrical"}), 2,
               {"--integrator cylindrical", "is for meshes", "builtin:hydrogen"});
  write("s.json", R"({"tetravox":1,"data":{"file":"builtin:hydrogen"},"render":{"integrator":"cylindrical"}})");
  expect_error(run({"render", "s.json"}), 1, {"render.integrator 'cylindrical'", "is for meshes"});
}

TEST_F(Errors, OutputThatCannotBeWritten) {
  const std::vector<std::string> start{"render", "builtin:sphere", "--resolution", "16,16", "-o"};
  const auto draw = [&](const std::string& output) {
    std::vector<std::string> arguments = start;
    arguments.push_back(output);
    return run(arguments);
  };
  expect_error(draw("missing/a.png"), 1, {"missing/a.png", "make the directory"});
  std::filesystem::create_directory(path("d.png"));
  expect_error(draw("d.png"), 1, {"d.png", "directory"});
  std::filesystem::remove(path("d.png"));
  std::filesystem::create_symlink("/dev/full", path("full.png"));
  expect_error(draw("full.png"), 1, {"full.png"});
  std::filesystem::remove(path("full.png"));
  if (::geteuid() != 0) {
    std::filesystem::create_directory(path("closed"));
    ::chmod(path("closed").c_str(), 0500);
    expect_error(draw("closed/a.png"), 1, {"closed/a.png"});
    ::chmod(path("closed").c_str(), 0700);
    std::filesystem::remove_all(path("closed"));
  }
  EXPECT_TRUE(names().empty());
}

TEST_F(Errors, TooLargeIsRefusedBeforeItHurts) {
  const auto pages = static_cast<double>(::sysconf(_SC_PHYS_PAGES)),
             page = static_cast<double>(::sysconf(_SC_PAGESIZE));
  if (pages * page > 30e9) GTEST_SKIP() << "this machine has memory enough for 500 million hexahedra";
  expect_error(run({"render", "builtin:duct?cells=500000000"}), 1, {"memory", "are free"});
}

}  // namespace
}  // namespace tetravox::cli
