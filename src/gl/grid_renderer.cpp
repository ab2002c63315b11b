#include "tetravox/error.h"
#include "tetravox/gl.h"

namespace tetravox {

Renderer make_gl_renderer(const PreparedGrid&, const GlOptions&) {
  throw Error(ErrorCode::kUnsupported, "the OpenGL backend does not draw grids yet: draw with --backend cpu");
}

}  // namespace tetravox
