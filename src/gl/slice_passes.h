#pragma once

/// The passes of the source `slices`: slabs of a grid, blended one after the other.

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/frame_parts.h"
#include "src/gl/grid_textures.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"
#include "src/gl/slice_geometry.h"
#include "src/gl/slice_light.h"
#include "src/gl/slice_programs.h"
#include "src/gl/slice_textures.h"
#include "src/grid/frame.h"
#include "src/scene/grid_view.h"
#include "tetravox/grid.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetravox::gl {

void free_query(GLuint name);

/// One frame: its rays begun.
struct SliceFrame {
  const PreparedGrid& grid;
  const grid::GridFrame& grid_frame;
  const scene::GridView& view;
  const GridTexture& values;
  IntegratorTables& tables;
  const FrameParts& parts;
  const RenderSettings& settings;
  const Context& context;
  const Progress& progress;
};

/// With the context current.
class SlicePasses {
 public:
  /// Draws into the frame's picture. @throws Error: kUnsupported for what slices do not draw (`require_sliceable`),
  /// kInvalidArgument for too many slices, kOutOfMemory, kCancelled.
  void draw(const SliceFrame& frame, RenderStatistics& statistics);
  std::uint64_t bytes() const;

 private:
  /// What one frame's passes share.
  struct Plan {
    SlicingRequest request;
    SliceVariant variant;
    IntegratorShader integrator;
    SlabFamily family;
    SliceBlock block;
    SliceTriangles slabs, slices;
    std::size_t first_slice_vertex = 0, first_box_vertex = 0, box_count = 0;
  };

  Plan make_plan(const SliceFrame& frame) const;
  void prepare(const SliceFrame& frame, Plan& plan);
  void upload_vertices(const Plan& plan, const SliceTriangles& box);
  void bind_values(const SliceFrame& frame, const Plan& plan);
  std::uint64_t count_rays(const Plan& plan);
  void draw_slabs(const SliceFrame& frame, const Plan& plan);
  void draw_half_angle(const SliceFrame& frame, const Plan& plan);
  void filter_slice(const SliceFrame& frame, const Plan& plan, int slice);
  void find_filtered(const SliceFrame& frame, const Plan& plan, int slab);
  void begin_query(std::size_t number);
  std::uint64_t add_up_queries(std::size_t count) const;
  GLuint find_program(const std::string& key, const std::vector<ShaderRecipe>& stages);

  std::map<std::string, ProgramName> programs_;
  std::vector<Name<free_query>> queries_;
  VertexArrayName attributes_;
  FramebufferName target_;
  std::array<FramebufferName, 2> slice_targets_;
  std::array<Picture, 2> filtered_;
  std::array<int, 2> held_{-1, -1};  // number of the slice that each of them holds
  Picture surface_colors_;
  Buffer block_, vertices_;
  SliceTextures textures_;
  SliceLight light_;
};

}  // namespace tetravox::gl
