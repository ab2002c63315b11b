#include "src/gl/shader_source.h"

#include "tetravox/error.h"

#include <algorithm>
#include <regex>

namespace tetravox::gl {
namespace {

/// Puts files together.
class Assembler {
 public:
  explicit Assembler(const ShaderRecipe& recipe) : recipe_(recipe) {}

  ShaderSource assemble() {
    source_.text = "#version 450 core\n";
    for (const auto& [name, value] : recipe_.defines) source_.text += "#define " + name + " " + value + "\n";
    append(recipe_.file);
    return std::move(source_);
  }

 private:
  static constexpr std::string_view kInclude = "#include \"";

  static std::string_view text_of(const std::string& name) {
    for (const ShaderFile& file : embedded_shaders())
      if (file.name == name) return file.text;
    throw Error(ErrorCode::kInternal, "there is no shader file '" + name + "'");
  }

  std::string resolve(const std::string& name) const {
    for (const auto& [from, to] : recipe_.includes)
      if (from == name) return to;
    return name;
  }

  void append(const std::string& name) {
    if (std::ranges::find(source_.files, name) != source_.files.end()) return;
    const std::string number = std::to_string(source_.files.size());
    source_.files.push_back(name);
    source_.text += "#line 1 " + number + "\n";
    std::string_view text = text_of(name);
    for (int line = 1; !text.empty(); ++line) {
      const std::string_view row = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(row.size() + 1, text.size()));
      if (!row.starts_with(kInclude)) {
        source_.text.append(row).append("\n");
        continue;
      }
      append(resolve(std::string(row.substr(kInclude.size(), row.rfind('"') - kInclude.size()))));
      source_.text += "#line " + std::to_string(line + 1) + " " + number + "\n";
    }
  }

  const ShaderRecipe& recipe_;
  ShaderSource source_;
};

}  // namespace

ShaderSource assemble_shader(const ShaderRecipe& recipe) { return Assembler(recipe).assemble(); }

std::string name_files(const std::string& log, const ShaderSource& source) {
  // Mesa says "2:15(3): error", others "2(15) : error" or "ERROR: 2:15:".
  static const std::regex place(R"((^|\n|ERROR: |WARNING: )(\d+)([:(]\d+))");
  std::string named;
  auto rest = log.cbegin();
  for (std::sregex_iterator match(log.begin(), log.end(), place), end; match != end; ++match) {
    const std::size_t file = std::stoul((*match)[2]);
    named.append(rest, (*match)[0].first).append((*match)[1]);
    named += (file < source.files.size() ? source.files[file] : std::string((*match)[2])) + std::string((*match)[3]);
    rest = (*match)[0].second;
  }
  return named.append(rest, log.cend());
}

}  // namespace tetravox::gl
