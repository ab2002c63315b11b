#pragma once

/// An OpenGL context without a window, by EGL.

#include "tetravox/gl.h"

#include <cstdint>
#include <memory>
#include <string>

namespace tetravox::gl {

/// What the device can hold: asked once, checked before anything is made.
struct Limits {
  std::uint64_t buffer_texels = 0;  ///< of a buffer texture
  std::uint64_t storage_bytes = 0;  ///< of a storage buffer
  int texture_size = 0;             ///< of a side of a 2D texture or a picture
  int volume_size = 0;              ///< of a side of a 3D texture
};

/// One context. Calls of OpenGL go between `make_current` and the end of what that returns, in any one thread.
class Context {
 public:
  /// @throws Error (kUnsupported) that says what is missing.
  static std::shared_ptr<Context> open(const GlOptions& options);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// Holds the context current in this thread; gives back what was current before.
  class Current {
   public:
    explicit Current(const Context& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    void* display_ = nullptr;
    void* before_display_ = nullptr;
    void* before_ = nullptr;
    void* before_draw_ = nullptr;
    void* before_read_ = nullptr;
  };
  Current make_current() const { return Current(*this); }

  const Limits& limits() const { return limits_; }
  const GlDevice& device() const { return device_; }

  /// @throws Error (kInternal or kOutOfMemory) with what the driver has complained of since the last call.
  void require_no_error(const std::string& where) const;
  /// Drops such a complaint, where the caller says it better.
  void forget_complaint() const { complaint_->clear(); }

 private:
  Context() = default;
  friend class ContextOpener;

  void* display_ = nullptr;
  void* context_ = nullptr;
  Limits limits_;
  GlDevice device_;
  std::unique_ptr<std::string> complaint_ = std::make_unique<std::string>();  // at an address the driver may keep
};

/// Frees what lives on the device of a context. Where that cannot be current in this thread, its names are left to the
/// end of the context.
template <class Parts>
void free_parts(const Context& context, std::unique_ptr<Parts>& parts) noexcept {
  try {
    const auto current = context.make_current();
    parts.reset();
  } catch (...) {
    static_cast<void>(parts.release());
  }
}

}  // namespace tetravox::gl
