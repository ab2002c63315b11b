#pragma once

/// The light's buffer of half-angle slices: how much light comes to each slab (Kniss, Premoze, Hansen, Ebert 2002).

#include "src/gl/blocks.h"
#include "src/gl/resources.h"
#include "src/gl/slice_geometry.h"
#include "src/scene/grid_view.h"
#include "tetravox/lighting.h"

#include <array>
#include <cstddef>

namespace tetravox::gl {

/// Two pictures, one of the light before a slab and one of that behind it: scattered light by colour, and the part that
/// comes straight. With the context current.
class SliceLight {
 public:
  /// All light comes to the first slab. Says in `block` where the buffer lies.
  void begin(const scene::GridView& view, const SlicingRequest& request, const SlabFamily& family,
             const Lighting& lighting, SliceBlock& block);
  /// Takes the light through a slab by the program of `recipe_of_light`, the block bound; the eye's slab may then be
  /// drawn. Leaves another framebuffer and viewport behind.
  void pass(GLuint program, int slab);
  /// Lets what is behind this slab be what comes before the next.
  void advance() { before_ = 1 - before_; }
  std::size_t bytes() const { return pictures_[0].get() ? pictures_[0].bytes() + pictures_[1].bytes() : 0; }

 private:
  std::array<Picture, 2> pictures_;
  std::array<FramebufferName, 2> targets_;
  int before_ = 0, resolution_ = 0;
};

}  // namespace tetravox::gl
