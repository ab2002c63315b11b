#pragma once

/// The passes that draw cells in order: as triangles from src/gl/decomposition.h, or as faces (`vicp`).

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/decomposition.h"
#include "src/gl/frame_parts.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"
#include "tetravox/mesh.h"
#include "tetravox/render.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace tetravox::gl {

/// What a fragment shader of projected cells is for.
struct ProjectionShader {
  IntegratorShader integrator;
  bool has_cell_data = false;
  bool is_orthographic = false;
  bool fills_lists = false;  ///< instead of blending
  bool use_outlines = false;
};

/// The shader programs of the sources `project` and `vicp`.
std::vector<ShaderRecipe> recipe_of_projection(const ProjectionShader& shader);
std::vector<ShaderRecipe> recipe_of_vicp(const ProjectionShader& shader);
ShaderRecipe recipe_of_decomposition(bool has_cell_data, bool use_outlines);

/// Draws into the framebuffer that is bound, blending as is set up. With the context current.
class ProjectionPasses {
 public:
  /// Uniforms of the draws to come.
  void set(const ProjectionBlock& block);

  /// Sends what `draw_triangles` draws.
  void send(const Projection& projection, bool use_outlines);
  /// The same, with triangles made on the device: twelve indices a cell. The mesh and the order have been sent (`keep`,
  /// `send`). `block` is for the draws to come. @throws Error (kUnsupported) where the device cannot hold them.
  void decompose(const Projection& projection, std::size_t cell_count, const ProjectionShader& shader,
                 const Limits& limits, ProjectionBlock block);
  void draw_triangles(const ProjectionShader& shader, std::size_t first_index, std::size_t count);

  /// Keeps vertices and cells of the mesh in its own frame.
  void keep(const PreparedMesh& mesh, std::span<const mesh::CellVertices> cells);
  /// Sends vertices as seen by the camera, and cells in order.
  void send(std::span<const float> seen, std::span<const mesh::CellVertices> cells, std::span<const float> cell_scalars,
            std::span<const std::uint32_t> order);
  /// Sends the order alone.
  void send(std::span<const std::uint32_t> order);
  /// Cells at places [first, first + count) of the order that was sent.
  void draw_faces(const ProjectionShader& shader, std::size_t first, std::size_t count);

  std::uint64_t bytes() const;

 private:
  void send_indices(const Projection& projection);
  void bind_triangles(bool use_outlines);
  const ProgramName& find_program(const std::string& key, const std::vector<ShaderRecipe>& recipes);

  std::map<std::string, ProgramName> programs_;
  VertexArrayName triangles_, outlines_, no_attributes_;
  Buffer block_, vertices_, indices_;
  bool has_mesh_ = false;
  BufferTexture screen_vertices_;
  BufferTexture kept_vertices_, kept_cells_, kept_scalars_, sent_vertices_, sent_cells_, sent_scalars_, order_;
  std::vector<mesh::CellVertices> ordered_cells_;
  std::vector<float> ordered_scalars_;
};

}  // namespace tetravox::gl
