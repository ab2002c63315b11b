/// Every program that there may be compiles: offline, whatever driver is at hand.

#include "src/gl/all_programs.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

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
struct WrittenShader {
  std::string program;
  ShaderSource source;
  fs::path file;
};

constexpr std::size_t kPartCount = 8;

/// Each text once, of all texts every kPartCount-th.
std::vector<WrittenShader> write_shaders(const fs::path& folder, std::size_t part) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::vector<WrittenShader> shaders;
  std::set<std::string> seen;
  for (const ProgramRecipe& program : all_programs())
    for (const ShaderRecipe& recipe : program.stages) {
      ShaderSource source = assemble_shader(recipe);
      if (!seen.insert(source.text).second || seen.size() % kPartCount != part) continue;
      const fs::path file = folder / (std::to_string(shaders.size()) + "." + ending_of(recipe.stage));
      std::ofstream(file) << source.text;
      shaders.push_back({program.name, std::move(source), file});
    }
  return shaders;
}

/// Whether the validator is content with files, whose names stand one after the other.
bool is_valid(const std::string& files, const fs::path& log) {
  const std::string command = std::string(TETRAVOX_GLSLANG) + files + " > " + log.string() + " 2>&1";
  return std::system(command.c_str()) == 0;
}

/// Parts, because there are so many that they keep one core busy for minutes.
class OfflineShaders : public ::testing::TestWithParam<std::size_t> {};

TEST_P(OfflineShaders, OfEveryProgramCompile) {
  const fs::path folder = fs::path(TETRAVOX_BINARY_DIR) / "shaders" / std::to_string(GetParam()), log = folder / "log";
  const std::vector<WrittenShader> shaders = write_shaders(folder, GetParam());
  EXPECT_GT(shaders.size(), 100u);
  // All at once, which spares starting the validator hundreds of times; one by one where something is wrong.
  std::string files;
  for (const WrittenShader& shader : shaders) files.append(" ").append(shader.file.string());
  if (is_valid(files, log)) return;
  for (const WrittenShader& shader : shaders)
    EXPECT_TRUE(is_valid(std::string(" ").append(shader.file.string()), log))
        << shader.program << ": " << name_files(read_text(log), shader.source);
}

INSTANTIATE_TEST_SUITE_P(Part, OfflineShaders, ::testing::Range(std::size_t{0}, kPartCount));
#else
TEST(OfflineShaders, OfEveryProgramCompile) { GTEST_SKIP() << "glslangValidator is not installed"; }
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
