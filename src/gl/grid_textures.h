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
/// value is missing. All three can be filtered by the device; a place in grid coordinates is the middle of texel
/// `place` of point data.
class GridTexture {
 public:
  /// @throws Error as `Volume::make`. `grid` must outlive the call only.
  GridTexture(const PreparedGrid& grid, const Context& context);

  const Volume& volume() const { return volume_; }
  const TexelMap& map() const { return map_; }
  std::uint64_t bytes() const { return volume_.bytes(); }

 private:
  Volume volume_;
  TexelMap map_;
};

/// What a value of 8 or 16 bits is as a texel in [0, 1], and back.
bool keeps_integers(const GridData& grid);

}  // namespace tetravox::gl
