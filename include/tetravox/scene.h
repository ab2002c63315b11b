#pragma once

/// The scene: everything that a picture depends on, and its JSON file, version 1 (docs/scene_file.md).

#include "tetravox/camera.h"
#include "tetravox/dataset.h"
#include "tetravox/render.h"
#include "tetravox/transfer_function.h"

#include <array>
#include <optional>
#include <string>

namespace tetravox {

/// Which step of a file with several: by index or by value (the nearest step).
struct TimeRequest {
  std::optional<std::size_t> index;
  std::optional<double> value;
};

struct SceneData {
  std::string file;           ///< a path, relative to the scene file or absolute, or "builtin:NAME"
  std::string solution_file;  ///< PLOT3D: the solution (Q) that goes with the grid `file`; otherwise empty
  ArrayRequest array;
  TimeRequest time;
};

struct Scene {
  SceneData data;
  std::optional<TransferFunction> transfer_function;  ///< empty: from the data's histogram
  std::optional<Camera> camera;                       ///< empty: an oblique view of everything
  Color background{0, 0, 0};
  RenderSettings settings;  ///< `threads` and `instruction_set` are not part of a scene file: no pixel depends on them
};

/// Parses a scene file's text.
/// @throws Error (kBadFile) that names `source_name`, the key or the place, and what is wrong. Unknown keys are an
/// error.
Scene parse_scene(const std::string& text, const std::string& source_name);

/// The scene as JSON text that `parse_scene` reads back to the same scene, exactly.
std::string format_scene(const Scene& scene);

/// What is drawn where the scene leaves it open, from the data: the function of `make_default_transfer_function`, and
/// the view of `make_default_camera`, but fitted to the mesh itself instead of its bounds.
struct CompletedScene {
  TransferFunction transfer_function;
  OpticalFunction optical_function;
  Camera camera;
};
CompletedScene complete_scene(const Scene& scene, const PreparedMesh& mesh);

/// Histogram of the field over the prepared mesh, in values, weighted by volume; `bins` in [1, 2^20]. Values count as
/// linear in a cell (point data) or constant (cell data). Meshes above 100,000 cells are sampled evenly. A few outliers
/// that would press everything else into one bin are left to the outermost bins. `unit_distance` follows the mean chord
/// of the mesh, so that thin bodies are drawn denser. The same on every run, for any number of threads.
/// @throws Error (kInvalidArgument) for a number of bins out of range.
Histogram make_histogram(const PreparedMesh& mesh, int bins = 256);

}  // namespace tetravox
