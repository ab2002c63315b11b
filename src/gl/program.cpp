#include "src/gl/program.h"

#include "tetravox/error.h"

#include <string>
#include <vector>

namespace tetravox::gl {
namespace {

void free_shader(GLuint name) { glDeleteShader(name); }
using ShaderName = Name<free_shader>;

GLenum kind_of(ShaderStage stage) {
  switch (stage) {
    case ShaderStage::kVertex:
      return GL_VERTEX_SHADER;
    case ShaderStage::kFragment:
      return GL_FRAGMENT_SHADER;
    case ShaderStage::kCompute:
      break;
  }
  return GL_COMPUTE_SHADER;
}

ShaderName compile(const ShaderRecipe& recipe) {
  const ShaderSource source = assemble_shader(recipe);
  ShaderName shader(glCreateShader(kind_of(recipe.stage)));
  const char* text = source.text.c_str();
  glShaderSource(shader.get(), 1, &text, nullptr);
  glCompileShader(shader.get());
  GLint is_compiled = 0, length = 0;
  glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &is_compiled);
  if (is_compiled) return shader;
  glGetShaderiv(shader.get(), GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length), '\0');
  glGetShaderInfoLog(shader.get(), length, nullptr, log.data());
  throw Error(ErrorCode::kInternal, "OpenGL: the driver does not compile " + name_files(log.c_str(), source));
}

}  // namespace

ProgramName make_program(std::span<const ShaderRecipe> stages) {
  ProgramName program(glCreateProgram());
  std::vector<ShaderName> shaders;
  for (const ShaderRecipe& recipe : stages) {
    shaders.push_back(compile(recipe));
    glAttachShader(program.get(), shaders.back().get());
  }
  glLinkProgram(program.get());
  for (const ShaderName& shader : shaders) glDetachShader(program.get(), shader.get());
  GLint is_linked = 0, length = 0;
  glGetProgramiv(program.get(), GL_LINK_STATUS, &is_linked);
  if (is_linked) return program;
  glGetProgramiv(program.get(), GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length), '\0');
  glGetProgramInfoLog(program.get(), length, nullptr, log.data());
  throw Error(ErrorCode::kInternal, "OpenGL: the driver does not link " + stages.back().file + ": " + log.c_str());
}

}  // namespace tetravox::gl
