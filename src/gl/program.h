#pragma once

/// Programs of the device from shader files.

#include "src/gl/resources.h"
#include "src/gl/shader_source.h"

#include <span>

namespace tetravox::gl {

/// Compiles and links. @throws Error (kInternal) with file and line where a driver does not take a shader.
ProgramName make_program(std::span<const ShaderRecipe> stages);

}  // namespace tetravox::gl
