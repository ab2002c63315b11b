#include "src/gl/resources.h"

#include <array>

namespace tetravox::gl {

void free_buffer(GLuint name) { glDeleteBuffers(1, &name); }
void free_texture(GLuint name) { glDeleteTextures(1, &name); }
void free_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
void free_program(GLuint name) { glDeleteProgram(name); }
void free_vertex_array(GLuint name) { glDeleteVertexArrays(1, &name); }

void Buffer::reserve(std::size_t bytes) {
  if (name_ && bytes <= bytes_) return;
  GLuint name = 0;
  glCreateBuffers(1, &name);
  name_ = Name<free_buffer>(name);
  glNamedBufferData(name, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_DRAW);
  bytes_ = bytes;
}

void Buffer::upload(const void* data, std::size_t bytes) {
  reserve(bytes);
  if (bytes) glNamedBufferSubData(get(), 0, static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::write(std::size_t offset, const void* data, std::size_t bytes) const {
  if (bytes) glNamedBufferSubData(get(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::clear_to_zero(std::size_t bytes) const {
  constexpr GLuint kZero = 0;
  glClearNamedBufferSubData(get(), GL_R32UI, 0, static_cast<GLsizeiptr>(bytes), GL_RED_INTEGER, GL_UNSIGNED_INT,
                            &kZero);
}

void Buffer::download(void* data, std::size_t bytes) const {
  glGetNamedBufferSubData(get(), 0, static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::bind_uniform(GLuint binding) const { glBindBufferBase(GL_UNIFORM_BUFFER, binding, get()); }
void Buffer::bind_storage(GLuint binding) const { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, get()); }

void BufferTexture::upload(GLenum format, const void* data, std::size_t bytes) {
  constexpr std::array<float, 4> kNothing{};
  const std::size_t before = buffer_.bytes();
  if (bytes > 0)
    buffer_.upload(data, bytes);
  else
    buffer_.upload(kNothing.data(), sizeof(kNothing));
  if (texture_ && format == format_ && buffer_.bytes() == before) return;
  if (!texture_) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &name);
    texture_ = TextureName(name);
  }
  glTextureBuffer(texture_.get(), format, buffer_.get());
  format_ = format;
}

void BufferTexture::bind(GLuint unit) const { glBindTextureUnit(unit, texture_.get()); }

void Picture::resize(GLenum format, int width, int height) {
  if (texture_ && format == format_ && width == width_ && height == height_) return;
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  texture_ = TextureName(name);
  glTextureStorage2D(name, 1, format, width, height);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  format_ = format;
  width_ = width;
  height_ = height;
}

void Picture::bind_image(GLuint unit, GLenum access) const {
  glBindImageTexture(unit, texture_.get(), 0, GL_FALSE, 0, access, format_);
}
void Picture::bind_texture(GLuint unit) const { glBindTextureUnit(unit, texture_.get()); }

std::size_t Picture::bytes() const {
  const std::size_t pixel = format_ == GL_RGBA32F || format_ == GL_RGBA32UI ? 16 : 4;
  return pixel * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
}

}  // namespace tetravox::gl
