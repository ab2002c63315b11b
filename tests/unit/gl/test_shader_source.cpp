#include "src/gl/shader_source.h"

#include "tetravox/error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tetravox::gl {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

const ShaderRecipe kWalk{
    ShaderStage::kCompute, "walk.comp", {{"NAME", "7"}}, {{"integrator.glsl", "integrators/partial.glsl"}}};

TEST(ShaderSource, BeginsWithVersionAndDefines) {
  EXPECT_EQ(assemble_shader(kWalk).text.find("#version 450 core\n#define NAME 7\n#line 1 0\n"), 0u);
}

TEST(ShaderSource, ResolvesEveryIncludeOnce) {
  const ShaderSource source = assemble_shader(kWalk);
  EXPECT_EQ(source.text.find("#include"), std::string::npos);
  EXPECT_EQ(count(source.text, "struct Segment {"), 1u) << "asked for by several files";
  EXPECT_EQ(source.files.front(), "walk.comp");
  EXPECT_NE(std::ranges::find(source.files, "integrators/partial.glsl"), source.files.end());
  EXPECT_EQ(std::ranges::find(source.files, "integrator.glsl"), source.files.end()) << "stands for another";
}

TEST(ShaderSource, LinesPointAtTheirFile) {
  // Every line of the text, taken back to its file by the directives, is that line there.
  const ShaderSource source = assemble_shader(kWalk);
  std::size_t file = source.files.size(), line = 0, checked = 0;
  for (std::string_view rest = source.text; !rest.empty();) {
    const std::string_view row = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(row.size() + 1, rest.size()));
    if (row.starts_with("#line ")) {
      const std::string numbers(row.substr(6));
      line = std::stoul(numbers);
      file = std::stoul(numbers.substr(numbers.find(' ')));
      continue;
    }
    if (file == source.files.size()) continue;  // version and defines
    const auto found = std::ranges::find(embedded_shaders(), source.files[file], &ShaderFile::name);
    ASSERT_NE(found, embedded_shaders().end());
    std::string_view text = found->text;
    for (std::size_t i = 1; i < line; ++i) text.remove_prefix(text.find('\n') + 1);
    EXPECT_EQ(row, text.substr(0, text.find('\n'))) << source.files[file] << ":" << line;
    ++line;
    ++checked;
  }
  EXPECT_GT(checked, 200u);
}

TEST(ShaderSource, RefusesAFileThatThereIsNot) {
  EXPECT_THROW(assemble_shader({ShaderStage::kCompute, "no_such.comp", {}, {}}), Error);
}

TEST(ShaderSource, LogsNameFilesInPlaceOfNumbers) {
  const ShaderSource source{"", {"walk.comp", "mesh.glsl"}};
  EXPECT_EQ(name_files("1:15(3): error: no\n0:2(1): error: x", source),
            "mesh.glsl:15(3): error: no\nwalk.comp:2(1): error: x");
  EXPECT_EQ(name_files("ERROR: 1:15: no", source), "ERROR: mesh.glsl:15: no");
  EXPECT_EQ(name_files("1(15) : error C1", source), "mesh.glsl(15) : error C1");
  EXPECT_EQ(name_files("9:1(1): error", source), "9:1(1): error") << "no such file";
}

}  // namespace
}  // namespace tetravox::gl
