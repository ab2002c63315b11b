#include "src/cpu/kernels/kernels.h"

#include "tetravox/error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tetravox::cpu {
namespace {

TEST(Kernels, EveryInstructionSetHasEveryKernel) {
  const auto names = available_instruction_sets();
  ASSERT_FALSE(names.empty());
  EXPECT_EQ(names.front(), best_instruction_set());
  for (const std::string& name : names) {
    const Kernels& kernels = kernels_for(name);
    EXPECT_NE(kernels.rasterize_face, nullptr) << name;
    EXPECT_NE(kernels.walk_antiderivative, nullptr) << name;
    EXPECT_NE(kernels.walk_gentle_antiderivative, nullptr) << name;
    EXPECT_NE(kernels.walk_partial, nullptr) << name;
    EXPECT_NE(kernels.walk_post, nullptr) << name;
    EXPECT_NE(kernels.walk_cells, nullptr) << name;
    EXPECT_NE(kernels.tables.walk, nullptr) << name;
    EXPECT_NE(kernels.tables.look_up, nullptr) << name;
  }
}

TEST(Kernels, AnUnknownInstructionSetIsAnErrorThatListsThem) {
  try {
    kernels_for("MMX");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_NE(std::string(error.what()).find(best_instruction_set()), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tetravox::cpu
