#pragma once

/// The passes of the source `walk`: where rays enter the mesh, and their way through it.

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/frame_parts.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetravox::gl {

/// What the walk of a frame is compiled for.
struct WalkVariant {
  bool has_cell_data = false;
  bool is_behind_eye = false;  ///< whether rays may walk behind the eye, where nothing is drawn
  EntryOrder order = EntryOrder::kLists;
};

/// One frame, its mesh and tables bound.
struct WalkFrame {
  WalkBlock block;
  FrameParts& parts;
  const RenderSettings& settings;
  IntegratorShader integrator;
  WalkVariant variant;
  const Limits& limits;
  const Progress& progress;
  int row_begin = 0, row_end = 0;  ///< set by `WalkPasses::draw`, which takes a part of the picture at a time
};

/// The shader programs of a frame by `walk`.
std::vector<ShaderRecipe> recipe_of_lists();
std::vector<ShaderRecipe> recipe_of_peeling();
ShaderRecipe recipe_of_sorting();
ShaderRecipe recipe_of_walk(const IntegratorShader& integrator, const WalkVariant& variant);

/// With the context current.
class WalkPasses {
 public:
  /// What a ray that needs another pass is kept in, each pixel.
  static constexpr std::size_t kPauseBytes = 48;

  /// Draws into the frame's picture. @throws Error: kCancelled; kOutOfMemory where the lists exceed the device.
  void draw(const WalkFrame& frame, RenderStatistics& statistics);
  std::uint64_t bytes() const;

 private:
  void draw_rows(const WalkFrame& frame, RenderStatistics& statistics);
  void prepare(const WalkFrame& frame);
  void collect_entries(const WalkFrame& frame, WalkBlock& block);
  void sort_entries(const WalkFrame& frame, WalkBlock block);
  void peel_layer(const WalkFrame& frame, const WalkBlock& block);
  std::uint64_t walk(const WalkFrame& frame, WalkBlock& block, RenderStatistics& statistics);
  void upload(const WalkBlock& block);

  std::map<std::string, ProgramName> programs_;
  VertexArrayName no_attributes_;
  FramebufferName no_target_, peel_target_;
  Picture front_faces_, peel_depths_;
  Buffer block_, counters_, entries_, heads_, pauses_, peeled_;
};

}  // namespace tetravox::gl
