#include "src/gl/context.h"

#include "tests/common/gl.h"
#include "tetravox/error.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <future>

namespace tetravox::gl {
namespace {

TEST(Context, ListsDevicesThatSayWhatTheyAre) {
  TETRAVOX_REQUIRE_GL();
  for (const GlDevice& device : gl_devices()) {
    EXPECT_FALSE(device.name.empty());
    EXPECT_FALSE(device.version.empty());
    if (device.name.find("llvmpipe") != std::string::npos) {
      EXPECT_TRUE(device.is_software) << device.name;
    }
  }
}

TEST(Context, RefusesADeviceThatThereIsNot) {
  TETRAVOX_REQUIRE_GL();
  try {
    Context::open({.device = 31});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
    EXPECT_NE(std::string(error.what()).find("no device 31"), std::string::npos) << error.what();
  }
}

TEST(Context, KnowsTheLimitsOfItsDevice) {
  TETRAVOX_REQUIRE_GL();
  const Limits limits = Context::open({})->limits();
  EXPECT_GE(limits.texture_size, 16384) << "what OpenGL 4.5 promises";
  EXPECT_GE(limits.volume_size, 2048);
  EXPECT_GE(limits.buffer_texels, 65536u);
  EXPECT_GE(limits.storage_bytes, 1u << 27);
}

TEST(Context, IsCurrentWhereItIsAskedForAndNowhereElse) {
  TETRAVOX_REQUIRE_GL();
  const auto context = Context::open({});
  const auto version = [] { return glGetString(GL_VERSION) != nullptr; };
  const auto has_any = [] { return eglGetCurrentContext() != EGL_NO_CONTEXT; };
  EXPECT_FALSE(has_any()) << "opened";
  {
    const auto current = context->make_current();
    EXPECT_TRUE(version());
    EXPECT_FALSE(std::async(std::launch::async, has_any).get()) << "another thread";
  }
  EXPECT_FALSE(has_any()) << "let go";
  EXPECT_TRUE(std::async(std::launch::async,
                         [&] {
                           const auto current = context->make_current();
                           return version();
                         })
                  .get())
      << "another thread";
}

TEST(Context, GivesBackWhatWasCurrent) {
  TETRAVOX_REQUIRE_GL();
  const auto outer = Context::open({}), inner = Context::open({});
  const auto held = outer->make_current();
  GLuint buffer = 0;
  glCreateBuffers(1, &buffer);
  { const auto other = inner->make_current(); }
  EXPECT_TRUE(glIsBuffer(buffer));
  glDeleteBuffers(1, &buffer);
}

TEST(Context, ComplaintsOfTheDriverBecomeErrors) {
  TETRAVOX_REQUIRE_GL();
  const auto context = Context::open({});
  const auto current = context->make_current();
  EXPECT_NO_THROW(context->require_no_error("nothing"));
  glBindBufferBase(GL_UNIFORM_BUFFER, 100000, 0);
  EXPECT_THROW(context->require_no_error("a bad binding"), Error);
  EXPECT_NO_THROW(context->require_no_error("what was reported is forgotten"));
}

}  // namespace
}  // namespace tetravox::gl
