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

namespace {

/// Slices of a grid as texels.
class SliceReader {
 public:
  explicit SliceReader(const PreparedGrid& grid)
      : data_(grid.data),
        reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}),
        is_integer_(scalar_type_size(data_.type) <= 2 && data_.component != kMagnitude),
        texel_bytes_(is_integer_ ? scalar_type_size(data_.type) : sizeof(float)) {
    const auto values = data_.value_dimensions();
    size_ = {static_cast<int>(values[0]), static_cast<int>(values[1]), static_cast<int>(values[2])};
  }

  bool is_integer() const { return is_integer_; }
  std::size_t texel_bytes() const { return texel_bytes_; }
  const std::array<int, 3>& size() const { return size_; }
  std::size_t slice_texels() const { return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]); }
  GLenum type() const { return !is_integer_ ? GL_FLOAT : texel_bytes_ == 1 ? GL_UNSIGNED_BYTE : GL_UNSIGNED_SHORT; }

  /// Valid until the next call.
  const std::byte* read(int k) {
    const std::size_t first = static_cast<std::size_t>(k) * slice_texels();
    if (!is_integer_) {
      bytes_.resize(slice_texels() * sizeof(float));
      reader_.read({{0, 0, k}, {size_[0], size_[1], 1}}, reinterpret_cast<float*>(bytes_.data()));
    } else if (data_.components == 1 && !is_signed(data_.type)) {
      return data_.values.data() + first * texel_bytes_;
    } else if (texel_bytes_ == 1) {
      copy_slice<std::uint8_t>(data_, first, slice_texels(), bytes_);
    } else {
      copy_slice<std::uint16_t>(data_, first, slice_texels(), bytes_);
    }
    return bytes_.data();
  }

 private:
  const GridData& data_;
  grid::BlockReader reader_;
  bool is_integer_;
  std::size_t texel_bytes_;
  std::array<int, 3> size_{};
  std::vector<std::byte> bytes_;
};

/// Four values in each texel; beyond the border that of the border.
void gather_squares(const std::byte* slice, const std::array<int, 3>& size, std::size_t bytes,
                    std::vector<std::byte>& to) {
  const auto columns = static_cast<std::size_t>(size[0]), rows = static_cast<std::size_t>(size[1]);
  to.resize(4 * columns * rows * bytes);
  std::byte* out = to.data();
  for (std::size_t j = 0; j < rows; ++j) {
    const std::byte* low = slice + j * columns * bytes;
    const std::byte* high = slice + std::min(j + 1, rows - 1) * columns * bytes;
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t next = std::min(i + 1, columns - 1);
      for (const std::byte* from : {low + i * bytes, low + next * bytes, high + i * bytes, high + next * bytes}) {
        std::memcpy(out, from, bytes);
        out += bytes;
      }
    }
  }
}

}  // namespace

GridTexture::GridTexture(const PreparedGrid& grid, const Context& context) : grid_(grid) {
  SliceReader slices(grid);
  const auto& size = slices.size();
  const bool is_byte = slices.texel_bytes() == 1;
  volume_.make(!slices.is_integer() ? GL_R32F : is_byte ? GL_R8 : GL_R16, size, context);
  // For who asks for filtered texels; all others fetch them.
  glTextureParameteri(volume_.get(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(volume_.get(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (int k = 0; k < size[2]; ++k)
    glTextureSubImage3D(volume_.get(), 0, 0, 0, k, size[0], size[1], 1, GL_RED, slices.type(), slices.read(k));
  has_floats_ = !slices.is_integer();
  if (has_floats_) return;
  const double largest = is_byte ? 255.0 : 65535.0;
  const double lowest = is_signed(grid.data.type) ? (is_byte ? -128.0 : -32768.0) : 0.0;
  map_ = {static_cast<float>((lowest - grid.scalar_offset) / grid.scalar_scale),
          static_cast<float>(largest / grid.scalar_scale)};
}

const Volume* GridTexture::squares(const Context& context) {
  if (bytes_of_squares(volume_) == 0) return nullptr;
  if (has_tried_squares_) return squares_.get() ? &squares_ : nullptr;
  has_tried_squares_ = true;
  SliceReader slices(grid_);
  const auto& size = slices.size();
  try {
    squares_.make(!slices.is_integer() ? GL_RGBA32F : slices.texel_bytes() == 1 ? GL_RGBA8 : GL_RGBA16, size, context);
  } catch (const Error&) {
    return nullptr;  // the values alone do as well, only slower
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  std::vector<std::byte> texels;
  for (int k = 0; k < size[2]; ++k) {
    gather_squares(slices.read(k), size, slices.texel_bytes(), texels);
    glTextureSubImage3D(squares_.get(), 0, 0, 0, k, size[0], size[1], 1, GL_RGBA, slices.type(), texels.data());
  }
  return &squares_;
}

}  // namespace tetravox::gl
