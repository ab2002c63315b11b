#include "src/gl/context.h"

#include "tetravox/error.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace tetravox::gl {

namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::kUnsupported, "OpenGL: " + what); }

std::string text_of(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

bool is_software(const std::string& renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "SwiftShader"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

/// The displays to try, one a device; Mesa's surfaceless platform where devices cannot be listed.
std::vector<EGLDisplay> find_displays() {
  std::vector<EGLDisplay> displays;
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
      epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration")) {
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count))
      for (EGLint i = 0; i < count; ++i)
        displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
  }
  if (displays.empty() && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  std::erase(displays, EGL_NO_DISPLAY);
  return displays;
}

/// Complaints of the driver that are errors become the text that `user` points at.
void APIENTRY note_message(GLenum source, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* message,
                           const void* user) {
  // What the compiler of shaders says is asked for where one is made.
  if (type != GL_DEBUG_TYPE_ERROR || source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
  auto& complaint = *static_cast<std::string*>(const_cast<void*>(user));
  if (complaint.empty()) complaint.assign(message, static_cast<std::size_t>(std::max(length, 0)));
}

Limits query_limits() {
  Limits limits;
  const auto query = [](GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return value;
  };
  limits.buffer_texels = static_cast<std::uint64_t>(query(GL_MAX_TEXTURE_BUFFER_SIZE));
  limits.storage_bytes = static_cast<std::uint64_t>(query(GL_MAX_SHADER_STORAGE_BLOCK_SIZE));
  limits.texture_size = static_cast<int>(query(GL_MAX_TEXTURE_SIZE));
  limits.volume_size = static_cast<int>(query(GL_MAX_3D_TEXTURE_SIZE));
  return limits;
}

}  // namespace

Context::Current::Current(const Context& context)
    : display_(context.display_),
      before_display_(eglGetCurrentDisplay()),
      before_(eglGetCurrentContext()),
      before_draw_(eglGetCurrentSurface(EGL_DRAW)),
      before_read_(eglGetCurrentSurface(EGL_READ)) {
  if (!eglMakeCurrent(context.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_))
    fail("the context cannot be used in this thread; is it in use in another?");
}

Context::Current::~Current() {
  if (before_ != EGL_NO_CONTEXT)
    eglMakeCurrent(before_display_, before_draw_, before_read_, before_);
  else
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/// Opens contexts on displays.
class ContextOpener {
 public:
  /// Null where the display has no OpenGL 4.5.
  static std::shared_ptr<Context> try_open(EGLDisplay display) {
    EGLint major = 0, minor = 0;
    if (!eglInitialize(display, &major, &minor) || !eglBindAPI(EGL_OPENGL_API)) return nullptr;
    constexpr std::array<EGLint, 9> kWanted{EGL_CONTEXT_MAJOR_VERSION,
                                            4,
                                            EGL_CONTEXT_MINOR_VERSION,
                                            5,
                                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                            EGL_CONTEXT_OPENGL_DEBUG,
                                            EGL_TRUE,
                                            EGL_NONE};
    const EGLContext made = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kWanted.data());
    if (made == EGL_NO_CONTEXT) return nullptr;
    std::shared_ptr<Context> context(new Context);
    context->display_ = display;
    context->context_ = made;
    std::optional<Context::Current> current;
    try {
      current.emplace(*context);
    } catch (const Error&) {
      return nullptr;  // others may do
    }
    const std::string renderer = text_of(GL_RENDERER);
    context->device_ = {renderer, text_of(GL_VERSION), is_software(renderer)};
    context->limits_ = query_limits();
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(note_message, context->complaint_.get());
    return context;
  }
};

std::shared_ptr<Context> Context::open(const GlOptions& options) {
  std::vector<std::shared_ptr<Context>> contexts;
  for (const EGLDisplay display : find_displays())
    if (auto context = ContextOpener::try_open(display)) contexts.push_back(std::move(context));
  if (contexts.empty())
    fail(
        "no device here offers version 4.5 by EGL: install a driver (Debian: libegl1 and libgl1-mesa-dri draw without "
        "graphics hardware), or draw with --backend cpu");
  if (options.device >= static_cast<int>(contexts.size()))
    fail("there is no device " + std::to_string(options.device) + "; there are " + std::to_string(contexts.size()) +
         ", counted from 0");
  if (options.device >= 0) return contexts[static_cast<std::size_t>(options.device)];
  const auto hardware = std::ranges::find_if(contexts, [](const auto& c) { return !c->device_.is_software; });
  return hardware != contexts.end() ? *hardware : contexts.front();
}

Context::~Context() {
  if (context_) eglDestroyContext(display_, context_);
}

void Context::require_no_error(const std::string& where) const {
  const GLenum code = glGetError();
  const std::string complaint = std::exchange(*complaint_, {});
  if (code == GL_NO_ERROR && complaint.empty()) return;
  if (code == GL_OUT_OF_MEMORY)
    throw Error(ErrorCode::kOutOfMemory, "OpenGL: " + where + ": the device (" + device_.name + ") is out of memory");
  throw Error(ErrorCode::kInternal,
              "OpenGL: " + where + ": " + (complaint.empty() ? "error " + std::to_string(code) : complaint));
}

}  // namespace tetravox::gl

namespace tetravox {

std::vector<GlDevice> gl_devices() {
  std::vector<GlDevice> devices;
  for (const EGLDisplay display : gl::find_displays())
    if (const auto context = gl::ContextOpener::try_open(display)) devices.push_back(context->device());
  return devices;
}

}  // namespace tetravox
