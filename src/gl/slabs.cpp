#include "src/gl/slabs.h"

#include "src/gl/march_bricks.h"
#include "src/optics/slab_table.h"

#include <span>

namespace tetravox::gl {
namespace {

constexpr int kNodes = optics::SlabTable::kNodes;
constexpr GLuint kFilledUnit = 1;  // image
constexpr GLuint kSlabUnit = 4;    // of the picture as a texture
constexpr GLuint kGroup = 8;       // invocations along a side

}  // namespace

ShaderRecipe recipe_of_slabs(const IntegratorShader& integrator) {
  ShaderRecipe recipe{ShaderStage::kCompute, "fill_slabs.comp", {}, {}};
  integrator.add_to(recipe);
  return recipe;
}

std::vector<IntegratorShader> slab_filling_shaders() {
  std::vector<IntegratorShader> shaders;
  for (const auto& all : {all_integrator_shaders(), bounded_integrator_shaders()})
    for (const IntegratorShader& shader : all)
      if (shader.name.starts_with("antiderivative") || shader.name.starts_with("gentle")) shaders.push_back(shader);
  return shaders;
}

IntegratorShader slab_shader() { return {"slabs", "integrators/slab.glsl", {}, 1}; }

void Slabs::describe(const ValueRange& scalars, MarchBlock& block) {
  const double width = optics::SlabTable::node_width(scalars);
  const double scale = width > 0.0 ? 1.0 / width : 1.0;
  block.slab_scale = static_cast<float>(scale / kNodes);
  block.slab_offset = static_cast<float>((0.5 - scalars.min * scale) / kNodes);
}

void Slabs::make(const MarchBlock& block, const IntegratorShader& integrator, double tolerance) {
  if (block.sample_distance == thickness_ && tolerance == tolerance_) return;
  auto program = programs_.find(integrator.name);
  if (program == programs_.end()) {
    const ShaderRecipe recipe = recipe_of_slabs(integrator);
    program = programs_.emplace(integrator.name, make_program(std::span(&recipe, 1))).first;
  }
  block_.upload(&block, sizeof(block));
  block_.bind_uniform(kMarchBinding);
  picture_.resize(GL_RGBA32F, kNodes, kNodes);
  picture_.bind_image(kFilledUnit, GL_WRITE_ONLY);
  glUseProgram(program->second.get());
  glDispatchCompute(kNodes / kGroup, kNodes / kGroup, 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  thickness_ = block.sample_distance;
  tolerance_ = tolerance;
}

void Slabs::bind() const { picture_.bind_texture(kSlabUnit); }

}  // namespace tetravox::gl
