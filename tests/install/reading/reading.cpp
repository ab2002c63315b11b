/// Reads a mesh with the installed library, draws it and writes a picture: reading IN OUT.

#include "tetravox/error.h"
#include "tetravox/io.h"

#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  const tetravox::Dataset dataset = tetravox::read_dataset(argv[1]);
  const tetravox::PreparedMesh mesh = tetravox::prepare_mesh(dataset.mesh);
  const tetravox::CompletedScene complete = tetravox::complete_scene({}, mesh);
  tetravox::write_image(argv[2], tetravox::render(mesh, complete.optical_function, complete.camera));
  return 0;
} catch (const tetravox::Error& error) {
  std::fprintf(stderr, "reading: %s\n", error.what());
  return 1;
}
