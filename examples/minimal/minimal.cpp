/// The smallest program on tetravox: an embedded mesh, a transfer function, a picture in memory.

#include "tetravox/error.h"
#include "tetravox/scene.h"

#include <cstdio>

int main() try {
  const tetravox::Dataset dataset = tetravox::make_builtin("sphere");
  const tetravox::PreparedMesh mesh = tetravox::prepare_mesh(dataset.mesh);

  tetravox::Scene scene;
  scene.transfer_function = tetravox::make_preset("viridis:constant", {.range = mesh.scalar_range});
  const tetravox::CompletedScene complete = tetravox::complete_scene(scene, mesh);
  const tetravox::Image image =
      tetravox::render(mesh, complete.optical_function, complete.camera, {.width = 64, .height = 48});

  // The sphere covers the middle of the picture and leaves its corner empty.
  const float middle = image.pixel(32, 24)[3];
  const float corner = image.pixel(0, 0)[3];
  std::printf("opacity: middle %.3f, corner %.3f\n", middle, corner);
  return middle > 0.1f && corner == 0.0f ? 0 : 1;
} catch (const tetravox::Error& error) {
  std::fprintf(stderr, "minimal: %s\n", error.what());
  return 1;
}
