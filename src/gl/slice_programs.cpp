#include "src/gl/slice_programs.h"

namespace tetravox::gl {
namespace {

/// Field and classification: the same for the eye and for the light.
void add_field(const IntegratorShader& integrator, const SliceVariant& variant, ShaderRecipe& recipe) {
  const auto define = [&](bool is_set, const char* name) {
    if (is_set) recipe.defines.emplace_back(name, "1");
  };
  const bool is_segment = variant.classification == SliceClassification::kSegment;
  const char* field = "slice_volume.glsl";
  if (variant.field == SliceField::kStack || variant.field == SliceField::kStripes) field = "slice_stack.glsl";
  const char* classify = is_segment ? "slice_classify_scalars.glsl" : "slice_classify_middle.glsl";
  if (variant.field == SliceField::kPictures) {
    field = "slice_pictures.glsl";
    classify = is_segment ? "slice_classify_filtered.glsl" : "slice_classify_filtered_middle.glsl";
  }
  define(variant.field == SliceField::kStripes, "STRIPES");
  define(variant.is_curved && is_segment, "CURVED");
  define(variant.classification == SliceClassification::kConstant, "CONSTANT");
  define(variant.classification == SliceClassification::kPre, "DENSITIES");
  recipe.includes.emplace_back("slice_field.glsl", field);
  recipe.includes.emplace_back("slice_classify.glsl", classify);
  if (is_segment) integrator.add_to(recipe);
}

}  // namespace

std::string key_of(const IntegratorShader& integrator, const SliceVariant& variant) {
  std::string key = variant.classification == SliceClassification::kSegment ? integrator.name : "middle";
  for (const int part : {static_cast<int>(variant.field), static_cast<int>(variant.classification), int{variant.is_lit},
                         int{variant.has_kernel_gradients}, int{variant.has_surfaces}, int{variant.is_half_angle},
                         int{variant.is_curved}})
    key.append(" ").append(std::to_string(part));
  return key;
}

std::vector<ShaderRecipe> recipe_of_box() {
  return {{ShaderStage::kVertex, "slice.vert", {}, {}}, {ShaderStage::kFragment, "slice_box.frag", {}, {}}};
}

std::vector<ShaderRecipe> recipe_of_slab(const IntegratorShader& integrator, const SliceVariant& variant) {
  ShaderRecipe slab{ShaderStage::kFragment, "slice_slab.frag", {}, {}};
  add_field(integrator, variant, slab);
  if (variant.is_lit) slab.defines.emplace_back("LIT", "1");
  if (variant.has_surfaces) slab.defines.emplace_back("SURFACES", "1");
  if (variant.is_half_angle) slab.defines.emplace_back("HALF_ANGLE", "1");
  slab.includes.emplace_back("slice_gradient.glsl", variant.has_kernel_gradients ? "slice_gradient_pictures.glsl"
                                                                                 : "slice_gradient_texture.glsl");
  return {{ShaderStage::kVertex, "slice.vert", {}, {}}, slab};
}

std::vector<ShaderRecipe> recipe_of_light(const IntegratorShader& integrator, const SliceVariant& variant) {
  ShaderRecipe light{ShaderStage::kFragment, "slice_light.frag", {}, {}};
  add_field(integrator, variant, light);
  return {{ShaderStage::kVertex, "slice_light.vert", {}, {}}, light};
}

std::vector<ShaderRecipe> recipe_of_filter() {
  return {{ShaderStage::kVertex, "slice.vert", {}, {}}, {ShaderStage::kFragment, "slice_filter.frag", {}, {}}};
}

ShaderRecipe recipe_of_stack() { return {ShaderStage::kCompute, "slice_stack.comp", {}, {}}; }
ShaderRecipe recipe_of_gradients() { return {ShaderStage::kCompute, "slice_gradients.comp", {}, {}}; }

std::vector<SliceVariant> slice_variants() {
  std::vector<SliceVariant> variants;
  for (const SliceField field : {SliceField::kVolume, SliceField::kStack, SliceField::kStripes, SliceField::kPictures})
    for (const SliceClassification classification : {SliceClassification::kSegment, SliceClassification::kPost,
                                                     SliceClassification::kPre, SliceClassification::kConstant}) {
      const bool is_constant = classification == SliceClassification::kConstant;
      const bool has_pictures = field == SliceField::kPictures;
      if (has_pictures && (is_constant || classification == SliceClassification::kPre)) continue;
      variants.push_back({.field = field, .classification = classification});
      variants.push_back({.field = field, .classification = classification, .is_lit = true});
      if (has_pictures)
        variants.push_back(
            {.field = field, .classification = classification, .is_lit = true, .has_kernel_gradients = true});
      // Half-angle slices are planes of their own, through a 3D texture.
      if (field == SliceField::kVolume)
        variants.push_back({.field = field, .classification = classification, .is_lit = true, .is_half_angle = true});
    }
  for (std::size_t i = 0, count = variants.size(); i < count; ++i) {
    if (variants[i].classification != SliceClassification::kSegment) continue;
    variants.push_back(variants[i]);
    variants.back().is_curved = true;
  }
  for (std::size_t i = 0, count = variants.size(); i < count; ++i) {
    if (variants[i].classification == SliceClassification::kConstant || variants[i].is_half_angle) continue;
    variants.push_back(variants[i]);
    variants.back().has_surfaces = true;
  }
  return variants;
}

}  // namespace tetravox::gl
