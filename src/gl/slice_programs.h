#pragma once

/// The shader programs of the source `slices`.

#include "src/gl/integrator_tables.h"
#include "src/gl/shader_source.h"

#include <string>
#include <vector>

namespace tetravox::gl {

/// Where slices take the field from.
enum class SliceField {
  kVolume,   ///< a 3D texture
  kStack,    ///< a stack of 2D textures
  kStripes,  ///< the same, slabs cut into stripes between its textures
  kPictures  ///< slices filtered before (Hadwiger, Theussl, Hauser, Groeller 2001)
};

/// How a slab is classified.
enum class SliceClassification { kSegment, kPost, kPre, kConstant };

/// What a frame's shaders must know before they are compiled.
struct SliceVariant {
  SliceField field = SliceField::kVolume;
  SliceClassification classification = SliceClassification::kSegment;
  bool is_lit = false;
  bool has_kernel_gradients = false;  ///< kPictures: those of the filter, instead of central differences
  bool has_surfaces = false;
  bool is_half_angle = false;
  bool is_curved = false;  ///< kSegment: slabs of several segments
};

/// A name of its own for each program of slabs.
std::string key_of(const IntegratorShader& integrator, const SliceVariant& variant);

std::vector<ShaderRecipe> recipe_of_box();
std::vector<ShaderRecipe> recipe_of_slab(const IntegratorShader& integrator, const SliceVariant& variant);
/// Half-angle: the light's way through a slab.
std::vector<ShaderRecipe> recipe_of_light(const IntegratorShader& integrator, const SliceVariant& variant);
std::vector<ShaderRecipe> recipe_of_filter();
ShaderRecipe recipe_of_stack();
ShaderRecipe recipe_of_gradients();

/// All variants that there may be.
std::vector<SliceVariant> slice_variants();

}  // namespace tetravox::gl
