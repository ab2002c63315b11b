/// Every program that there may be compiles: offline, whatever driver is at hand.

#include "src/gl/all_programs.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace tetravox::gl {
namespace {

namespace fs = std::filesystem;

const char* ending_of(ShaderStage stage) {
  switch (stage) {
    case ShaderStage::kVertex:
      return "vert";
    case ShaderStage::kFragment:
      return "frag";
    case ShaderStage::kCompute:
      break;
  }
  return "comp";
}

std::string read_text(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

#ifdef TETRAVOX_GLSLANG
/// What the validator complains of; empty where it is content.
std::string validate(const ShaderSource& source, ShaderStage stage, const fs::path& folder) {
  const fs::path file = folder / (std::string("shader.") + ending_of(stage)), log = folder / "log";
  std::ofstream(file) << source.text;
  const std::string command = std::string(TETRAVOX_GLSLANG) + " " + file.string() + " > " + log.string() + " 2>&1";
  return std::system(command.c_str()) == 0 ? "" : name_files(read_text(log), source);
}

TEST(Shaders, EveryProgramCompilesOffline) {
  const fs::path folder = fs::path(TETRAVOX_BINARY_DIR) / "shaders";
  fs::create_directories(folder);
  std::set<std::string> seen;
  for (const ProgramRecipe& program : all_programs())
    for (const ShaderRecipe& recipe : program.stages) {
      const ShaderSource source = assemble_shader(recipe);
      if (!seen.insert(source.text).second) continue;
      EXPECT_EQ(validate(source, recipe.stage, folder), "") << program.name;
    }
  EXPECT_GT(seen.size(), 10u);
}
#else
TEST(Shaders, EveryProgramCompilesOffline) { GTEST_SKIP() << "glslangValidator is not installed"; }
#endif

/// Files that no program uses are left over.
TEST(Shaders, EveryFileBelongsToAProgram) {
  std::set<std::string> used;
  for (const ProgramRecipe& program : all_programs())
    for (const ShaderRecipe& recipe : program.stages)
      for (const std::string& file : assemble_shader(recipe).files) used.insert(file);
  for (const ShaderFile& file : embedded_shaders()) EXPECT_TRUE(used.contains(std::string(file.name))) << file.name;
}

}  // namespace
}  // namespace tetravox::gl
