#pragma once

/// The scene: everything that a picture depends on, and its JSON file, version 1 (docs/scene_file.md).

#include "tetravox/camera.h"
#include "tetravox/dataset.h"
#include "tetravox/grid.h"
#include "tetravox/multidimensional.h"
#include "tetravox/render.h"
#include "tetravox/transfer_function.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace tetravox {

/// Which step of a file with several: by index or by value (the nearest step).
struct TimeRequest {
  std::optional<std::size_t> index;
  std::optional<double> value;
};

/// How the bytes of a RAW file are to be understood. What is left empty is taken from the file's name
/// (name_256x256x256_uint8.raw).
struct RawLayout {
  std::optional<std::array<std::uint32_t, 3>> dimensions;
  std::optional<ScalarType> type;
  std::optional<int> components;  ///< interleaved, in [1, 4]
  std::optional<std::array<double, 3>> spacing;
  std::optional<bool> is_big_endian;
  std::uint64_t header_bytes = 0;  ///< to leave out at the beginning
};

struct SceneData {
  std::string file;           ///< a path, relative to the scene file or absolute, or "builtin:NAME"
  std::string solution_file;  ///< PLOT3D: the solution (Q) that goes with the grid `file`; otherwise empty
  ArrayRequest array;
  TimeRequest time;
  RawLayout raw;
};

struct Scene {
  SceneData data;
  std::optional<TransferFunction> transfer_function;         ///< empty: from the data's histogram
  std::optional<MultidimensionalFunction> multidimensional;  ///< in its place
  std::optional<ColorBy> color_by;                           ///< colours in place of those of `transfer_function`
  std::optional<Camera> camera;                              ///< empty: an oblique view of everything
  Color background{0, 0, 0};
  RenderSettings settings;  ///< `threads` and `instruction_set` are not part of a scene file: no pixel depends on them
};

/// The arrays that a scene needs beside the one that is drawn, as `ReadOptions::others` takes them: of the variables
/// in their order, then the one that colours follow.
std::vector<ArrayRequest> other_arrays(const Scene& scene);

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
CompletedScene complete_scene(const Scene& scene, const PreparedGrid& grid);

/// Histogram of the field over the prepared mesh, in values, weighted by volume; `bins` in [1, 2^20]. Values count as
/// linear in a cell (point data) or constant (cell data). Meshes above 100,000 cells are sampled evenly. A few outliers
/// that would press everything else into one bin are left to the outermost bins. `unit_distance` follows the mean chord
/// of the mesh, so that thin bodies are drawn denser. The same on every run, for any number of threads.
/// @throws Error (kInvalidArgument) for a number of bins out of range.
Histogram make_histogram(const PreparedMesh& mesh, int bins = 256);
/// The same for a grid, of its values (weighted by the volume of their cells where axes are uneven).
Histogram make_histogram(const PreparedGrid& grid, int bins = 256);

}  // namespace tetravox
