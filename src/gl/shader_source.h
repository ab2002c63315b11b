#pragma once

/// Shaders as text: the files of src/gl/shaders put together for one program.

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetravox::gl {

struct ShaderFile {
  std::string_view name;  ///< below src/gl/shaders
  std::string_view text;
};

/// All of them, as they were at build time.
std::span<const ShaderFile> embedded_shaders();

enum class ShaderStage { kVertex, kFragment, kCompute };

/// What a shader is made of.
struct ShaderRecipe {
  ShaderStage stage = ShaderStage::kCompute;
  std::string file;                                           ///< with `main`
  std::vector<std::pair<std::string, std::string>> defines;   ///< name, value
  std::vector<std::pair<std::string, std::string>> includes;  ///< what `#include "name"` stands for, where not a file
};

/// One text with its files told apart by `#line`.
struct ShaderSource {
  std::string text;
  std::vector<std::string> files;  ///< by the number that `#line` gives
};

/// Resolves `#include "file"`, each file once, and puts version and defines in front.
/// @throws Error (kInternal) for a file that there is not.
ShaderSource assemble_shader(const ShaderRecipe& recipe);

/// A compiler's log with names of files in place of their numbers.
std::string name_files(const std::string& log, const ShaderSource& source);

}  // namespace tetravox::gl
