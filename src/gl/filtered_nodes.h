#pragma once

/// Lattices of filtered values (src/scene/kernel_lattice.h) on the device, as many bricks at a time as fit.

#include "src/gl/context.h"
#include "src/gl/resources.h"
#include "src/optics/antiderivative_table.h"
#include "src/scene/brick_plan.h"
#include "src/scene/grid_view.h"
#include "src/scene/kernel_lattice.h"
#include "tetravox/progress.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::gl {

/// What a frame filters. Views everything.
struct FilteredBricks {
  const scene::PlanSources* sources = nullptr;
  const std::vector<scene::BrickPlan>* plans = nullptr;
  scene::KernelField field;
  const optics::ControlPointTable* points = nullptr;  ///< set for pre-classification: densities instead of scalars
};

/// Where a brick's nodes are: index of the first, parts of a cell along each axis (0: not there).
struct NodePlace {
  std::uint32_t first = 0, parts = 0;
};

/// With the context current.
class FilteredNodes {
 public:
  /// Texels that bricks take on the device at most.
  static constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 24;

  /// Drops what belongs to other plans.
  void forget() { is_whole_ = false; }
  /// Begins a frame: bricks in the order in which rays meet them.
  void begin(const grid::GridFrame& frame, const scene::GridView& view, const FilteredBricks& bricks,
             const Limits& limits);
  /// Puts the next bricks on the device, and where they are into `places` [bricks]; false where they are the last.
  bool next(const FilteredBricks& bricks, const Progress& progress, std::vector<NodePlace>& places);
  void bind(GLuint unit) const { nodes_.bind(unit); }
  std::uint64_t bytes() const { return nodes_.bytes(); }

 private:
  std::vector<std::uint32_t> order_;
  std::size_t done_ = 0;
  bool is_whole_ = false;  ///< everything is there already
  std::uint64_t room_ = 0;
  std::vector<NodePlace> kept_;
  BufferTexture nodes_;
};

}  // namespace tetravox::gl
