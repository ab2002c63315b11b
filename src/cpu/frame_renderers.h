#pragma once

/// What draws frames on the CPU.

#include "src/cpu/kernels/kernels.h"
#include "src/scene/frame_renderer.h"
#include "src/scene/preintegration_cache.h"
#include "tetravox/grid.h"
#include "tetravox/mesh.h"
#include "tetravox/render.h"

#include <memory>

namespace tetravox::cpu {

/// @throws Error (kNothingToDraw, kUnsupported) for a mesh without cells, or with too many.
std::unique_ptr<scene::FrameRenderer> make_mesh_renderer(const PreparedMesh& mesh);
std::unique_ptr<scene::FrameRenderer> make_grid_renderer(const PreparedGrid& grid);

/// Hands the table of ray integrals at hand to a frame. Valid as long as the cache.
void attach_preintegration(const scene::PreintegrationCache& cache, IntegratorTables& tables);

/// Writes down what drew a frame.
void note_backend(const RenderSettings& settings, RenderStatistics& statistics);

}  // namespace tetravox::cpu
