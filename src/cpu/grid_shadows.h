#pragma once

/// What absorbs along lines through a grid.

#include "src/cpu/grid_frame.h"
#include "src/cpu/lattice_walk.h"
#include "src/cpu/planned_brick.h"
#include "src/cpu/shadow_rays.h"

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <span>

namespace tetravox::cpu {

/// How exact, and what gradients are.
struct GridShadowSettings {
  float allowed_rate = 0.0f, most_pieces = 12.0f;  ///< see MarchJob
  std::array<float, 9> camera_from_gradient{};     ///< see Effects
};

/// Goes from brick to brick and from cell to cell (Amanatides and Woo 1987). Bricks that the plan leaves out are passed
/// at once, those of one value too. In a cell the scalar is a cubic, cut into linear pieces as in the picture.
class GridShadows final : public ShadowMedium {
 public:
  GridShadows(const PlannedGrid& grid, const scene::LocalFrame& local, const ShadowOptics& optics,
              const GridShadowSettings& settings);

  void gather(const ShadowLine& line, std::span<const DepthRange> kept, Transmission& sum) const override;

 private:
  class Walk;
  struct Bricks;

  DepthLine grid_line(const ShadowLine& line) const;

  PlannedGrid grid_;
  scene::LocalFrame local_;
  ShadowOptics optics_;
  GridShadowSettings settings_;
  std::array<double, 3> upper_{};  ///< of the grid; its lower corner is 0
  mutable tbb::enumerable_thread_specific<BrickStore> stores_;
};

}  // namespace tetravox::cpu
