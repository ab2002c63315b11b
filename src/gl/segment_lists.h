#pragma once

/// Lists of the segments of each pixel, sorted on the device: the order of cells does not matter then.

#include "src/gl/context.h"
#include "src/gl/frame_parts.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"

#include <cstdint>
#include <functional>
#include <map>

namespace tetravox::gl {

ShaderRecipe recipe_of_resolving(const IntegratorShader& integrator, bool has_cell_data);

/// With the context current.
class SegmentLists {
 public:
  /// Calls `draw(node_count)` for bands of the picture, as high as the lists have room for, with the lists bound and
  /// only the band's rows let through, and composites what it put into them. How many segments there were.
  /// @throws Error: kOutOfMemory where a single row exceeds the device; kCancelled.
  std::uint64_t resolve(FrameParts& parts, const RenderSettings& settings, const IntegratorShader& integrator,
                        bool has_cell_data, const Limits& limits, const Progress& progress,
                        const std::function<void(std::uint32_t)>& draw);
  std::uint64_t bytes() const { return counters_.bytes() + nodes_.bytes() + heads_.bytes(); }

 private:
  std::map<std::string, ProgramName> programs_;
  Buffer counters_, nodes_, heads_;
};

}  // namespace tetravox::gl
