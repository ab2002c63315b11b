#pragma once

/// What rays must know of the bricks of a grid, on the device.

#include "src/gl/blocks.h"
#include "src/gl/filtered_nodes.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/resources.h"
#include "src/grid/frame.h"
#include "src/scene/brick_plan.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::gl {

/// Texture units of the source `march`.
inline constexpr GLuint kBrickUnit = 6, kPlaneUnit = 7, kSteepnessUnit = 8, kValueUnit = 9, kSquareUnit = 10;

/// Of its uniform block.
inline constexpr GLuint kMarchBinding = 2;

/// A brick's plan as shaders have it (march.glsl): level, stride, flags. Steps are of the values themselves, which cost
/// no more here than those of larger cells; what remains of levels is one cell for all of a constant brick.
std::uint32_t pack_plan(scene::BrickPlan plan, bool has_missing);

/// What rays do in the bricks that are seen.
struct RaySteps {
  bool has_strides = false;  ///< equal steps in some
  bool has_cells = false;    ///< from cell to cell in some
  SegmentBounds segments;
};

/// World lengths of the longest segments.
struct StepLengths {
  double cell = 0.0;     ///< of one cell
  double sampled = 0.0;  ///< of a step at a fixed rate; 0: there is none
};

RaySteps find_ray_steps(const scene::PlanSources& sources, const std::vector<scene::BrickPlan>& plans,
                        const StepLengths& lengths, const IntegratorTables& tables);

/// Plans, steepness table, planes of uneven axes. With the context current.
class MarchBricks {
 public:
  void upload(const scene::PlanSources& sources, const std::vector<scene::BrickPlan>& plans,
              const grid::GridFrame& frame);
  /// Says where the nodes of filtered bricks are, [bricks].
  void place_nodes(const std::vector<NodePlace>& places);
  void bind() const;
  std::uint64_t bytes() const { return plans_.bytes() + steepness_.bytes() + planes_.bytes(); }

 private:
  std::vector<std::array<std::uint32_t, 4>> records_;  ///< plan, bits of the steepness, first node, parts
  BufferTexture plans_, steepness_, planes_;
};

}  // namespace tetravox::gl
