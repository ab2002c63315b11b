#include "src/gl/program.h"

#include "src/gl/all_programs.h"
#include "src/gl/context.h"
#include "tests/common/gl.h"
#include "tetravox/error.h"

namespace tetravox::gl {
namespace {

TEST(Program, TheDriverTakesEveryProgram) {
  TETRAVOX_REQUIRE_GL();
  const auto context = Context::open({});
  const auto current = context->make_current();
  for (const ProgramRecipe& program : all_programs()) EXPECT_NO_THROW(make_program(program.stages)) << program.name;
}

TEST(Program, ErrorsNameFileAndLine) {
  TETRAVOX_REQUIRE_GL();
  const auto context = Context::open({});
  const auto current = context->make_current();
  const ShaderRecipe broken[] = {
      {ShaderStage::kCompute, "walk.comp", {{"front_at", "no_such_function"}}, {{"integrator.glsl", "segment.glsl"}}}};
  try {
    make_program(broken);
    FAIL();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.find("walk.comp:") != std::string::npos || text.find("walk.comp(") != std::string::npos) << text;
  }
}

}  // namespace
}  // namespace tetravox::gl
