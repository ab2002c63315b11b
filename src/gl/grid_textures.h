#pragma once

/// The values of a grid on the device, as a 3D texture.

#include "src/gl/context.h"
#include "src/gl/resources.h"
#include "src/grid/values.h"
#include "tetravox/grid.h"

#include <array>
#include <cstdint>

namespace tetravox::gl {

/// A 3D texture of one level, clamped to its edges. With the context current.
class Volume {
 public:
  /// @throws Error (kUnsupported) where a side exceeds the device's limit, (kOutOfMemory) where it has no room.
  void make(GLenum format, const std::array<int, 3>& size, const Context& context);
  void bind(GLuint unit) const { glBindTextureUnit(unit, texture_.get()); }
  GLuint get() const { return texture_.get(); }
  const std::array<int, 3>& size() const { return size_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  TextureName texture_;
  std::array<int, 3> size_{};
  std::uint64_t bytes_ = 0;
};

/// How texels stand for stored scalars: stored = offset + texel * scale.
struct TexelMap {
  float offset = 0.0f;
  float scale = 1.0f;
};

/// The component that is drawn, a texel a value, i fastest. What has 8 or 16 bits keeps them (GL_R8, GL_R16; signed
/// numbers are shifted to begin at 0); everything else becomes the stored scalars themselves (GL_R32F), NaN where a
/// value is missing. All three can be filtered by the device; the middle of texel i is at grid coordinate i of point
/// data, i + 1/2 of cell data.
class GridTexture {
 public:
  /// `grid` must outlive this. @throws Error as `Volume::make`.
  GridTexture(const PreparedGrid& grid, const Context& context);

  const Volume& volume() const { return volume_; }
  /// The same with four values in each texel: (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1), made when it is first
  /// asked for. Two fetches are all corners of a cell then, for four times the memory. Null where that is too much.
  const Volume* squares(const Context& context);
  /// What they take; 0 where that is too much.
  static std::uint64_t bytes_of_squares(const Volume& values) {
    return 4 * values.bytes() > kMostBytesOfSquares ? 0 : 4 * values.bytes();
  }
  bool has_floats() const { return has_floats_; }
  const TexelMap& map() const { return map_; }
  std::uint64_t bytes() const { return volume_.bytes() + squares_.bytes(); }

 private:
  static constexpr std::uint64_t kMostBytesOfSquares = std::uint64_t{1} << 30;

  const PreparedGrid& grid_;
  Volume volume_, squares_;
  TexelMap map_;
  bool has_floats_ = false;
  bool has_tried_squares_ = false;
};

}  // namespace tetravox::gl
