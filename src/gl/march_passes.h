#pragma once

/// The passes of the source `march`: rays go through a grid, some bricks or steps a pass.

#include "src/gl/blocks.h"
#include "src/gl/frame_parts.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace tetravox::gl {

/// What a frame's shader must know before it is compiled.
struct MarchKind {
  Integrator integrator = Integrator::kAntiderivative;
  IntegratorShader shader;   ///< of the integrator, or of points
  bool is_uneven = false;    ///< axes with planes of their own
  bool is_constant = false;  ///< one value a cell
  bool is_nearest = false;   ///< of these: eighths of cells, each with the value of its corner
  bool has_nodes = false;    ///< lattices of filtered values instead of the grid's own
  bool has_squares = false;  ///< four values in each texel
  bool is_filtered = false;  ///< the device interpolates values, of `has_runs`
  bool has_samples = false;  ///< a fixed rate, samples counted on from cell to cell
  bool has_runs = false;     ///< a fixed rate, steps counted on through the whole grid (scene::counts_steps)
  // Of scalars that are no such samples:
  bool has_strides = false;  ///< bricks in which rays go in equal steps
  bool has_cells = true;     ///< bricks in which they go from cell to cell
};

/// The shader program of a frame by `march`; and all kinds that there are.
ShaderRecipe recipe_of_march(const MarchKind& kind);
std::vector<MarchKind> march_kinds();
/// Whether it looks up points, and integrates nothing.
bool takes_points(const MarchKind& kind);

/// One frame, its data and tables bound.
struct MarchFrame {
  MarchBlock block;
  MarchKind kind;
  FrameParts& parts;
  const RenderSettings& settings;
  const Limits& limits;
  const Progress& progress;
  /// With nodes: puts those of the next bricks on the device; false where they are the last.
  std::function<bool()> next_bricks = {};
  std::function<void()> begin_bricks = {};  ///< before the first of them
  int row_begin = 0, row_end = 0;           ///< set by `MarchPasses::draw`, which takes a part of the picture at a time
};

/// With the context current.
class MarchPasses {
 public:
  /// What a ray that needs another pass is kept in, each pixel.
  static constexpr std::size_t kPauseBytes = 48;

  /// Draws into the frame's picture. @throws Error (kCancelled).
  void draw(const MarchFrame& frame, RenderStatistics& statistics);
  std::uint64_t bytes() const { return block_.bytes() + counters_.bytes() + pauses_.bytes(); }

 private:
  struct Waiting;
  void draw_rows(const MarchFrame& frame, RenderStatistics& statistics);
  Waiting draw_pass(const MarchFrame& frame, const MarchBlock& block, RenderStatistics& statistics);

  std::map<std::string, ProgramName> programs_;
  Buffer block_, counters_, pauses_;
};

}  // namespace tetravox::gl
