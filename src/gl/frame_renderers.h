#pragma once

/// What draws frames by OpenGL.

#include "src/gl/context.h"
#include "src/scene/frame_renderer.h"
#include "tetravox/grid.h"
#include "tetravox/mesh.h"

#include <memory>

namespace tetravox::gl {

std::unique_ptr<scene::FrameRenderer> make_mesh_renderer(const PreparedMesh& mesh, std::shared_ptr<Context> context);
std::unique_ptr<scene::FrameRenderer> make_grid_renderer(const PreparedGrid& grid, std::shared_ptr<Context> context);

}  // namespace tetravox::gl
