#pragma once

/// What draws frames on the CPU.

#include "src/scene/frame_renderer.h"
#include "tetravox/grid.h"
#include "tetravox/mesh.h"
#include "tetravox/render.h"

#include <memory>

namespace tetravox::cpu {

/// @throws Error (kNothingToDraw, kUnsupported) for a mesh without cells, or with too many.
std::unique_ptr<scene::FrameRenderer> make_mesh_renderer(const PreparedMesh& mesh);
std::unique_ptr<scene::FrameRenderer> make_grid_renderer(const PreparedGrid& grid);

/// Writes down what drew a frame.
void note_backend(const RenderSettings& settings, RenderStatistics& statistics);

}  // namespace tetravox::cpu
