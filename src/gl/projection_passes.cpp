#include "src/gl/projection_passes.h"

#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace tetravox::gl {
namespace {

constexpr GLuint kProjectionBinding = 3;                                                     // uniform block
constexpr GLuint kVertexUnit = 6, kCellScalarUnit = 9, kCellVertexUnit = 7, kOrderUnit = 8;  // textures

constexpr GLuint kDrawnBinding = 0, kIndexBinding = 1;  // storage blocks

void add_defines(const ProjectionShader& shader, std::vector<ShaderRecipe>& stages) {
  for (ShaderRecipe& stage : stages) {
    if (shader.has_cell_data) stage.defines.emplace_back("CELL_DATA", "1");
    if (shader.is_orthographic) stage.defines.emplace_back("ORTHOGRAPHIC", "1");
    if (shader.fills_lists) stage.defines.emplace_back("EXACT_ORDER", "1");
    shader.integrator.add_to(stage);
  }
}

std::size_t indices_of(bool use_outlines) { return use_outlines ? 6 : 12; }

std::string key_of(const std::string& source, const ProjectionShader& shader) {
  std::string key = source;
  for (const auto& [holds, name] :
       {std::pair{shader.fills_lists, "lists"}, std::pair{shader.has_cell_data, "cells"},
        std::pair{shader.is_orthographic, "orthographic"}, std::pair{shader.use_outlines, "outlines"}})
    if (holds) key.append(" ").append(name);
  return key.append(" ").append(shader.integrator.name);
}

}  // namespace

std::vector<ShaderRecipe> recipe_of_projection(const ProjectionShader& shader) {
  std::vector<ShaderRecipe> stages{
      {ShaderStage::kVertex, shader.use_outlines ? "outline.vert" : "project.vert", {}, {}},
      {ShaderStage::kFragment, shader.use_outlines ? "vicp.frag" : "project.frag", {}, {}}};
  add_defines(shader, stages);
  return stages;
}

std::vector<ShaderRecipe> recipe_of_vicp(const ProjectionShader& shader) {
  std::vector<ShaderRecipe> stages{{ShaderStage::kVertex, "vicp.vert", {}, {}},
                                   {ShaderStage::kFragment, "vicp.frag", {}, {}}};
  add_defines(shader, stages);
  return stages;
}

ShaderRecipe recipe_of_decomposition(bool has_cell_data, bool use_outlines) {
  ShaderRecipe recipe{ShaderStage::kCompute, "decompose.comp", {}, {}};
  if (use_outlines) recipe.defines.emplace_back("OUTLINES", "1");
  if (has_cell_data) recipe.defines.emplace_back("CELL_DATA", "1");
  return recipe;
}

const ProgramName& ProjectionPasses::find_program(const std::string& key, const std::vector<ShaderRecipe>& recipes) {
  const auto found = programs_.find(key);
  if (found != programs_.end()) return found->second;
  return programs_.emplace(key, make_program(recipes)).first->second;
}

void ProjectionPasses::set(const ProjectionBlock& block) {
  block_.upload(&block, sizeof(block));
  block_.bind_uniform(kProjectionBinding);
}

void ProjectionPasses::send(const Projection& projection, bool use_outlines) {
  if (use_outlines)
    vertices_.upload(projection.outlines.data(), projection.outlines.size() * sizeof(OutlineVertex));
  else
    vertices_.upload(projection.drawn.data(), projection.drawn.size() * sizeof(ProjectedVertex));
  send_indices(projection);
  bind_triangles(use_outlines);
}

void ProjectionPasses::send_indices(const Projection& projection) {
  std::size_t bytes = 0;
  for (const auto& list : projection.indices) bytes += list.size() * sizeof(std::uint32_t);
  indices_.reserve(bytes);
  std::size_t offset = 0;
  for (const auto& list : projection.indices) {
    indices_.write(offset, list.data(), list.size() * sizeof(std::uint32_t));
    offset += list.size() * sizeof(std::uint32_t);
  }
}

void ProjectionPasses::decompose(const Projection& projection, std::size_t cell_count, const ProjectionShader& shader,
                                 const Limits& limits, ProjectionBlock block) {
  const std::size_t vertex_count = projection.vertices.size();
  const std::uint64_t vertex_bytes = shader.use_outlines ? 4 * cell_count * sizeof(OutlineVertex)
                                                         : (vertex_count + cell_count) * sizeof(ProjectedVertex);
  const std::uint64_t index_bytes = indices_of(shader.use_outlines) * cell_count * sizeof(std::uint32_t);
  if (std::max(vertex_bytes, index_bytes) > limits.storage_bytes || 3 * vertex_count > limits.buffer_texels)
    throw Error(ErrorCode::kUnsupported, "OpenGL: this device does not cut meshes of " + std::to_string(cell_count) +
                                             " tetrahedra into triangles: use --decomposition cpu");
  vertices_.reserve(vertex_bytes);
  if (!shader.use_outlines) vertices_.write(0, projection.drawn.data(), vertex_count * sizeof(ProjectedVertex));
  indices_.reserve(index_bytes);
  screen_vertices_.upload(GL_RG32UI, projection.vertices.data(), vertex_count * sizeof(ScreenVertex));
  screen_vertices_.bind(kVertexUnit);
  block.first_thick = static_cast<uint>(vertex_count);
  block.node_count = static_cast<uint>(cell_count);
  set(block);
  vertices_.bind_storage(kDrawnBinding);
  indices_.bind_storage(kIndexBinding);
  const std::string key =
      std::string("decompose") + (shader.has_cell_data ? " cells" : "") + (shader.use_outlines ? " outlines" : "");
  glUseProgram(find_program(key, {recipe_of_decomposition(shader.has_cell_data, shader.use_outlines)}).get());
  constexpr std::size_t kGroup = 64;
  glDispatchCompute(static_cast<GLuint>((cell_count + kGroup - 1) / kGroup), 1, 1);
  glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT);
  bind_triangles(shader.use_outlines);
}

void ProjectionPasses::bind_triangles(bool use_outlines) {
  VertexArrayName& array = use_outlines ? outlines_ : triangles_;
  if (!array) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    array = VertexArrayName(name);
    for (GLuint i = 0; i < 2; ++i) {
      glEnableVertexArrayAttrib(name, i);
      glVertexArrayAttribBinding(name, i, 0);
    }
    static_assert(offsetof(ProjectedVertex, x) == 0 && offsetof(OutlineVertex, x) == 0);
    glVertexArrayAttribFormat(name, 0, 2, GL_FLOAT, GL_FALSE, 0);
    if (use_outlines)
      glVertexArrayAttribIFormat(name, 1, 1, GL_UNSIGNED_INT, offsetof(OutlineVertex, place));
    else
      glVertexArrayAttribFormat(name, 1, 4, GL_FLOAT, GL_FALSE, offsetof(ProjectedVertex, carried));
  }
  glVertexArrayVertexBuffer(array.get(), 0, vertices_.get(), 0,
                            use_outlines ? sizeof(OutlineVertex) : sizeof(ProjectedVertex));
  glVertexArrayElementBuffer(array.get(), indices_.get());
}

void ProjectionPasses::draw_triangles(const ProjectionShader& shader, std::size_t first_index, std::size_t count) {
  glUseProgram(find_program(key_of("project", shader), recipe_of_projection(shader)).get());
  glBindVertexArray((shader.use_outlines ? outlines_ : triangles_).get());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(first_index * sizeof(std::uint32_t)));
}

void ProjectionPasses::keep(const PreparedMesh& mesh, std::span<const mesh::CellVertices> cells) {
  if (!has_mesh_) {
    kept_vertices_.upload(GL_RGBA32F, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vertex));
    kept_cells_.upload(GL_RGBA32UI, cells.data(), cells.size_bytes());
    kept_scalars_.upload(GL_R32F, mesh.cell_scalars.data(), mesh.cell_scalars.size() * sizeof(float));
    has_mesh_ = true;
  }
  kept_vertices_.bind(kVertexUnit);
  kept_cells_.bind(kCellVertexUnit);
  kept_scalars_.bind(kCellScalarUnit);
}

void ProjectionPasses::send(std::span<const float> seen, std::span<const mesh::CellVertices> cells,
                            std::span<const float> cell_scalars, std::span<const std::uint32_t> order) {
  ordered_cells_.resize(order.size());
  ordered_scalars_.resize(cell_scalars.empty() ? 0 : order.size());
  support::parallel_chunks(order.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ordered_cells_[i] = cells[order[i]];
      if (!cell_scalars.empty()) ordered_scalars_[i] = cell_scalars[order[i]];
    }
  });
  sent_vertices_.upload(GL_RGBA32F, seen.data(), seen.size_bytes());
  sent_cells_.upload(GL_RGBA32UI, ordered_cells_.data(), ordered_cells_.size() * sizeof(mesh::CellVertices));
  sent_scalars_.upload(GL_R32F, ordered_scalars_.data(), ordered_scalars_.size() * sizeof(float));
  sent_vertices_.bind(kVertexUnit);
  sent_cells_.bind(kCellVertexUnit);
  sent_scalars_.bind(kCellScalarUnit);
  order_.upload(GL_R32UI, nullptr, 0);
  order_.bind(kOrderUnit);
}

void ProjectionPasses::send(std::span<const std::uint32_t> order) {
  order_.upload(GL_R32UI, order.data(), order.size_bytes());
  order_.bind(kOrderUnit);
}

void ProjectionPasses::draw_faces(const ProjectionShader& shader, std::size_t first, std::size_t count) {
  // The projection does not matter to the shader.
  ProjectionShader any = shader;
  any.is_orthographic = any.use_outlines = false;
  glUseProgram(find_program(key_of("vicp", any), recipe_of_vicp(any)).get());
  if (!no_attributes_) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    no_attributes_ = VertexArrayName(name);
  }
  glBindVertexArray(no_attributes_.get());
  glDrawArrays(GL_TRIANGLES, static_cast<GLint>(12 * first), static_cast<GLsizei>(12 * count));
}

std::uint64_t ProjectionPasses::bytes() const {
  std::uint64_t sum = block_.bytes() + vertices_.bytes() + indices_.bytes() + screen_vertices_.bytes();
  for (const BufferTexture* texture :
       {&kept_vertices_, &kept_cells_, &kept_scalars_, &sent_vertices_, &sent_cells_, &sent_scalars_, &order_})
    sum += texture->bytes();
  return sum + ordered_cells_.capacity() * sizeof(mesh::CellVertices) + ordered_scalars_.capacity() * sizeof(float);
}

}  // namespace tetravox::gl
