#pragma once

/// For tests that need a device for OpenGL.

#include "tetravox/gl.h"

#include <gtest/gtest.h>

/// Skips a test where nothing here draws by OpenGL.
#define TETRAVOX_REQUIRE_GL() \
  if (tetravox::gl_devices().empty()) GTEST_SKIP() << "there is no device with OpenGL 4.5 by EGL"
