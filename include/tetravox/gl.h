#pragma once

/// OpenGL draws the same pictures: the renderers here take the place of those that draw on the CPU (render.h).
///
/// Needs OpenGL 4.5 by EGL, no display and no window; Mesa's llvmpipe serves where there is no graphics hardware.

#include "tetravox/grid.h"
#include "tetravox/mesh.h"
#include "tetravox/render.h"

#include <string>
#include <vector>

namespace tetravox {

/// A device that EGL offers.
struct GlDevice {
  std::string name;  ///< what OpenGL calls its renderer
  std::string version;
  bool is_software = false;
};

struct GlOptions {
  int device = -1;  ///< index into `gl_devices()`; -1: the first that is no software, otherwise the first
};

/// Those that can draw, in EGL's order; none where there is no EGL. Opens a context on each: tenths of a second.
std::vector<GlDevice> gl_devices();

/// The sources of this backend, each with the integrators that it draws by.
std::vector<SourceMethods> gl_methods();

/// A renderer that draws by OpenGL. Views the mesh or grid, which goes into buffers and textures at once. What it
/// cannot draw yet its `render` refuses by name.
/// @throws Error: kUnsupported where there is no such device, no OpenGL 4.5, or the data exceeds what the device holds;
/// kNothingToDraw for a mesh without cells.
Renderer make_gl_renderer(const PreparedMesh& mesh, const GlOptions& options = {});
Renderer make_gl_renderer(const PreparedGrid& grid, const GlOptions& options = {});

}  // namespace tetravox
