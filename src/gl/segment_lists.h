#pragma once

/// Lists of the segments of each pixel, sorted on the device: the order of cells does not matter then.

#include "src/gl/frame_parts.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/program.h"
#include "src/gl/projection_passes.h"
#include "src/gl/resources.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace tetravox::gl {

ShaderRecipe recipe_of_segment_sorting();
ShaderRecipe recipe_of_resolving(const IntegratorShader& integrator, bool has_cell_data);

/// One frame; its tables are bound.
struct ListFrame {
  FrameParts& parts;
  ProjectionPasses& passes;
  ProjectionBlock block;
  const RenderSettings& settings;
  IntegratorShader integrator;
  bool has_cell_data = false;
  const Limits& limits;
  const Progress& progress;
  std::function<void()> draw;  ///< the cells, into the lists that are bound
};

/// With the context current.
class SegmentLists {
 public:
  /// Of lists, unless the device allows less.
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;

  /// Calls `draw` for bands of the picture, as high as the lists have room for, with the lists bound and only the
  /// band's rows let through, and composites what it put into them. How many segments there were.
  /// @throws Error: kOutOfMemory where a single row exceeds the device; kUnsupported where a pixel has more segments
  /// than can be sorted; kCancelled.
  std::uint64_t resolve(const ListFrame& frame);
  std::uint64_t bytes() const { return counters_.bytes() + nodes_.bytes() + heads_.bytes(); }

 private:
  void clear(const ListFrame& frame, int rows);
  void sort(const ListFrame& frame, int rows);
  void composite(const ListFrame& frame, int rows);
  const ProgramName& find_program(const std::string& key, const ShaderRecipe& recipe);

  std::map<std::string, ProgramName> programs_;
  Buffer counters_, nodes_, heads_;
};

}  // namespace tetravox::gl
