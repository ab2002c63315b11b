#pragma once

/// Buffers, textures and programs that free themselves. All of it with the context current.

#include <epoxy/gl.h>

#include <cstddef>
#include <cstdint>
#include <utility>

namespace tetravox::gl {

/// A name of OpenGL, freed by `kFree`.
template <void (*kFree)(GLuint)>
class Name {
 public:
  Name() = default;
  explicit Name(GLuint name) : name_(name) {}
  Name(Name&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Name& operator=(Name&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Name() {
    if (name_) kFree(name_);
  }
  GLuint get() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  GLuint name_ = 0;
};

void free_buffer(GLuint name);
void free_texture(GLuint name);
void free_framebuffer(GLuint name);
void free_program(GLuint name);
void free_vertex_array(GLuint name);

using TextureName = Name<free_texture>;
using FramebufferName = Name<free_framebuffer>;
using ProgramName = Name<free_program>;
using VertexArrayName = Name<free_vertex_array>;

/// A capability of OpenGL that is on as long as this lives, and off afterwards.
class Enabled {
 public:
  explicit Enabled(GLenum capability) : capability_(capability) { glEnable(capability); }
  ~Enabled() { glDisable(capability_); }
  Enabled(const Enabled&) = delete;
  Enabled& operator=(const Enabled&) = delete;

 private:
  GLenum capability_;
};

/// Bytes on the device; grows as needed, never shrinks.
class Buffer {
 public:
  /// Makes the buffer hold these bytes, at its beginning.
  void upload(const void* data, std::size_t bytes);
  /// The same from an offset on; there must be room.
  void write(std::size_t offset, const void* data, std::size_t bytes) const;
  /// Makes room; what it held is lost where it must grow.
  void reserve(std::size_t bytes);
  void clear_to_zero(std::size_t bytes) const;
  void download(void* data, std::size_t bytes) const;
  void bind_uniform(GLuint binding) const;
  void bind_storage(GLuint binding) const;
  GLuint get() const { return name_.get(); }
  std::size_t bytes() const { return bytes_; }

 private:
  Name<free_buffer> name_;
  std::size_t bytes_ = 0;
};

/// A buffer read through a texture unit: `texelFetch` by index.
class BufferTexture {
 public:
  /// `format`: of a texel, as GL_RGBA32F. An empty upload keeps one texel of zeros, so that it can be bound.
  void upload(GLenum format, const void* data, std::size_t bytes);
  void bind(GLuint unit) const;
  std::size_t bytes() const { return buffer_.bytes(); }

 private:
  Buffer buffer_;
  TextureName texture_;
  GLenum format_ = 0;
};

/// A 2D picture of one level.
class Picture {
 public:
  /// Makes it that large; what it held is lost where that changes it.
  void resize(GLenum format, int width, int height);
  void bind_image(GLuint unit, GLenum access) const;
  void bind_texture(GLuint unit) const;
  GLuint get() const { return texture_.get(); }
  std::size_t bytes() const;

 private:
  TextureName texture_;
  GLenum format_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace tetravox::gl
