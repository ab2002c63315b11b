#include "src/gl/grid_textures.h"

#include "tetravox/error.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace tetravox::gl {
namespace {

/// Bytes a texel of the formats used here.
std::uint64_t texel_bytes(GLenum format) {
  switch (format) {
    case GL_R8:
      return 1;
    case GL_R16:
      return 2;
    case GL_RGBA8:
    case GL_R32F:
      return 4;
    case GL_RGBA16:
    case GL_RGBA16F:
      return 8;
    default:
      break;
  }
  return 16;
}

bool is_signed(ScalarType type) { return type == ScalarType::kInt8 || type == ScalarType::kInt16; }

/// One component of a slice, signed numbers shifted to begin at 0.
template <class T>
void copy_slice(const GridData& grid, std::size_t first, std::size_t count, std::vector<std::byte>& to) {
  constexpr auto kTop = static_cast<T>(T{1} << (8 * sizeof(T) - 1));
  const auto flip = is_signed(grid.type) ? kTop : T{0};
  to.resize(count * sizeof(T));
  const auto components = static_cast<std::size_t>(grid.components);
  const std::byte* from =
      grid.values.data() + (first * components + static_cast<std::size_t>(grid.component)) * sizeof(T);
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, from + i * components * sizeof(T), sizeof(T));
    value = static_cast<T>(value ^ flip);
    std::memcpy(to.data() + i * sizeof(T), &value, sizeof(T));
  }
}

}  // namespace

void Volume::make(GLenum format, const std::array<int, 3>& size, const Context& context) {
  const int largest = *std::max_element(size.begin(), size.end());
  if (largest > context.limits().volume_size)
    throw Error(ErrorCode::kUnsupported,
                "OpenGL: the grid has " + std::to_string(largest) + " values along an axis, more than the " +
                    std::to_string(context.limits().volume_size) + " of this device: draw with --backend cpu");
  context.require_no_error("before the grid");
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_3D, 1, &name);
  texture_ = TextureName(name);
  glTextureStorage3D(name, 1, format, size[0], size[1], size[2]);
  size_ = size;
  bytes_ = texel_bytes(format) * static_cast<std::uint64_t>(size[0]) * static_cast<std::uint64_t>(size[1]) *
           static_cast<std::uint64_t>(size[2]);
  // Drivers report a lack of memory as one error or another.
  if (glGetError() != GL_NO_ERROR) {
    texture_ = {};
    context.forget_complaint();
    throw Error(ErrorCode::kOutOfMemory, "OpenGL: the device (" + context.device().name +
                                             ") has no room for a grid of " + std::to_string(bytes_ >> 20) +
                                             " MB: draw with --backend cpu");
  }
  for (const GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(name, side, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

bool keeps_integers(const GridData& grid) { return scalar_type_size(grid.type) <= 2 && grid.component != kMagnitude; }

GridTexture::GridTexture(const PreparedGrid& grid, const Context& context) {
  const GridData& data = grid.data;
  const auto values = data.value_dimensions();
  const std::array<int, 3> size{static_cast<int>(values[0]), static_cast<int>(values[1]), static_cast<int>(values[2])};
  const bool is_integer = keeps_integers(data);
  const bool is_byte = scalar_type_size(data.type) == 1;
  const GLenum format = !is_integer ? GL_R32F : is_byte ? GL_R8 : GL_R16;
  const GLenum type = !is_integer ? GL_FLOAT : is_byte ? GL_UNSIGNED_BYTE : GL_UNSIGNED_SHORT;
  volume_.make(format, size, context);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);

  const std::size_t slice = values[0] * values[1];
  const grid::BlockReader reader(data, {grid.scalar_offset, grid.scalar_scale});
  std::vector<std::byte> bytes;
  std::vector<float> scalars(is_integer ? 0 : slice);
  for (std::size_t k = 0; k < values[2]; ++k) {
    const void* texels = nullptr;
    if (!is_integer) {
      reader.read({{0, 0, static_cast<std::int64_t>(k)},
                   {static_cast<std::int64_t>(values[0]), static_cast<std::int64_t>(values[1]), 1}},
                  scalars.data());
      texels = scalars.data();
    } else if (data.components == 1 && !is_signed(data.type)) {
      texels = data.values.data() + k * slice * scalar_type_size(data.type);
    } else {
      if (is_byte)
        copy_slice<std::uint8_t>(data, k * slice, slice, bytes);
      else
        copy_slice<std::uint16_t>(data, k * slice, slice, bytes);
      texels = bytes.data();
    }
    glTextureSubImage3D(volume_.get(), 0, 0, 0, static_cast<GLint>(k), size[0], size[1], 1, GL_RED, type, texels);
  }
  if (!is_integer) return;
  const double largest = is_byte ? 255.0 : 65535.0;
  const double lowest = is_signed(data.type) ? (is_byte ? -128.0 : -32768.0) : 0.0;
  map_ = {static_cast<float>((lowest - grid.scalar_offset) / grid.scalar_scale),
          static_cast<float>(largest / grid.scalar_scale)};
}

}  // namespace tetravox::gl
