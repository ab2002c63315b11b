#pragma once

/// The passes of the source `walk`: where rays enter the mesh, and their way through it.

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/frame_parts.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetravox::gl {

/// One frame, its mesh and tables bound.
struct WalkFrame {
  WalkBlock block;
  const FrameParts& parts;
  const RenderSettings& settings;
  bool has_cell_data = false;
  const Limits& limits;
  const Progress& progress;
};

/// The shader programs of a frame by `walk`.
std::vector<ShaderRecipe> recipe_of_lists();
ShaderRecipe recipe_of_sorting();
ShaderRecipe recipe_of_walk(Integrator integrator, bool has_cell_data);

/// With the context current.
class WalkPasses {
 public:
  /// Draws into the frame's picture. @throws Error: kCancelled; kOutOfMemory where the lists exceed the device.
  void draw(const WalkFrame& frame, RenderStatistics& statistics);
  std::uint64_t bytes() const;

 private:
  std::uint64_t collect_entries(const WalkFrame& frame, WalkBlock& block);
  void upload(const WalkBlock& block);

  std::map<std::string, ProgramName> programs_;
  VertexArrayName no_attributes_;
  FramebufferName no_target_;
  int target_width_ = 0, target_height_ = 0;
  Buffer block_, counters_, entries_, heads_, pauses_;
};

}  // namespace tetravox::gl
