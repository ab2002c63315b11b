#include "apps/tetravox/backend.h"

#include "apps/tetravox/method_choice.h"
#include "tetravox/error.h"
#include "tetravox/render.h"

#ifdef TETRAVOX_WITH_GL
#include "tetravox/gl.h"
#endif

namespace tetravox::tool {

#ifdef TETRAVOX_WITH_GL

namespace {

Renderer make_gl(const PreparedMesh& mesh, const GlOptions& options) { return make_gl_renderer(mesh, options); }
Renderer make_gl(const PreparedGrid& grid, const GlOptions& options) { return make_gl_renderer(grid, options); }

}  // namespace

Renderer make_renderer(const Body& body, const MethodOptions& method, const Scene& scene) {
  return std::visit(
      [&](const auto& prepared) {
        return draws_by_gl(method, scene.settings, scene.data.array.association)
                   ? make_gl(prepared, {method.gl_device.value_or(-1)})
                   : Renderer(prepared);
      },
      body);
}

std::vector<std::pair<std::string, std::string>> device_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const GlDevice& device : gl_devices())
    names.emplace_back(std::to_string(names.size()), device.name + ", OpenGL " + device.version);
  return names;
}

#else

Renderer make_renderer(const Body& body, const MethodOptions& method, const Scene& scene) {
  if (draws_by_gl(method, scene.settings, scene.data.array.association))
    throw Error(ErrorCode::kUnsupported,
                "this tetravox was built without OpenGL: draw with --backend cpu, a source of it and "
                "--preintegration-device cpu, or build with TETRAVOX_WITH_GL=ON");
  return std::visit([](const auto& prepared) { return Renderer(prepared); }, body);
}

std::vector<std::pair<std::string, std::string>> device_names() { return {}; }

#endif

std::vector<std::pair<std::string, std::string>> method_rows() {
  std::vector<SourceMethods> methods = cpu_methods();
#ifdef TETRAVOX_WITH_GL
  for (SourceMethods& method : gl_methods()) methods.push_back(std::move(method));
#endif
  std::vector<std::pair<std::string, std::string>> rows;
  for (const SourceMethods& method : methods) {
    std::string names;
    for (const Integrator integrator : method.integrators) names += (names.empty() ? "" : ", ") + name_of(integrator);
    rows.emplace_back(method.backend + " " + name_of(method.source), names);
  }
  return rows;
}

std::string describe_backend(const RenderStatistics& drawn) {
  if (!drawn.device.empty()) return drawn.device;
  return drawn.instruction_set + ", " + std::to_string(drawn.threads) + " threads";
}

}  // namespace tetravox::tool
