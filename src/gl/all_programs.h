#pragma once

/// Every program that the backend may ask a device to compile: for checking them all.

#include "src/gl/shader_source.h"

#include <string>
#include <vector>

namespace tetravox::gl {

struct ProgramRecipe {
  std::string name;
  std::vector<ShaderRecipe> stages;
};

std::vector<ProgramRecipe> all_programs();

}  // namespace tetravox::gl
