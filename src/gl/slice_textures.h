#pragma once

/// What slices read beside the grid's 3D texture: stacks of 2D textures, gradients, filters' kernels.

#include "src/gl/context.h"
#include "src/gl/grid_textures.h"
#include "src/gl/resources.h"
#include "src/grid/separable_kernel.h"
#include "tetravox/grid.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

namespace tetravox::gl {

/// Textures made from the values when a frame first asks for them. With the context current.
class SliceTextures {
 public:
  /// The stack of 2D textures along an axis: one array texture. All that have been asked for are kept: going round the
  /// grid takes three times its memory, as ever with such stacks. @throws Error as `Volume::make`.
  GLuint stack(int axis, const GridTexture& values, const Context& context);
  /// Central differences of the values, stored scalars a cell, in half precision.
  const Volume& gradients(const GridTexture& values, const Context& context);
  /// Puts the kernel of a filter into its table (of 2 radius tiles, [phases + 1][tiles]: weight, derivative) and, where
  /// it wants them, its coefficients in place of the values.
  void set_filter(const PreparedGrid& grid, const Filter& filter, const Context& context);

  const BufferTexture& kernel_tiles() const { return kernel_tiles_; }
  int kernel_radius() const { return kernel_ ? kernel_->radius() : 0; }
  /// Empty: the values serve.
  const std::optional<Volume>& coefficients() const { return coefficients_; }
  std::uint64_t bytes() const;

 private:
  ProgramName stack_program_, gradient_program_;
  std::array<TextureName, 3> stacks_;
  std::uint64_t stack_bytes_ = 0;
  std::optional<Volume> gradients_, coefficients_;
  Filter filter_;
  std::unique_ptr<grid::SeparableKernel> kernel_;
  BufferTexture kernel_tiles_;
};

}  // namespace tetravox::gl
