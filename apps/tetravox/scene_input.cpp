#include "apps/tetravox/scene_input.h"

#include "apps/tetravox/text.h"

#include "tetravox/error.h"

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <variant>

namespace tetravox::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestScene = std::uintmax_t{64} << 20;  // bytes

bool is_builtin(const std::string& path) { return path.starts_with("builtin:"); }

bool is_picture(const std::string& path) { return ending_of(path) == ".png" || ending_of(path) == ".exr"; }

std::string read_text(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw Error(ErrorCode::kBadFile, "'" + path + "' is a directory");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::generic_category().message(errno));
  std::string text;
  char part[65536];
  while (file.read(part, sizeof part) || file.gcount() > 0) {
    text.append(part, static_cast<std::size_t>(file.gcount()));
    if (text.size() > kLargestScene)
      throw Error(ErrorCode::kBadFile,
                  "'" + path + "' is larger than " + format_bytes(kLargestScene) + ": that is no scene file");
  }
  return text;
}

/// A path written in `scene_path`, as to open from the current directory.
std::string resolve(const std::string& scene_path, const std::string& file) {
  if (is_builtin(file) || file.empty() || fs::path(file).is_absolute()) return file;
  return (fs::path(scene_path).parent_path() / file).lexically_normal().string();
}

std::string stem_of(const std::string& input) {
  if (is_builtin(input)) return input.substr(8, input.find('?') - 8);
  fs::path path = fs::path(input).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // a directory with a slash at the end
  if (path == "." || path == ".." || path == "/") path = fs::absolute(path).lexically_normal().parent_path();
  const std::string stem = path.stem().string();
  return stem.empty() ? "picture" : stem;
}

/// Puts the command line's data options over those of the scene.
void override_data(const InputOptions& options, SceneData& data) {
  if (!options.array.empty()) {
    // Another array: what the scene says about the old one does not hold for it.
    data.array = {};
    data.array.name = options.array;
  }
  if (options.association) data.array.association = options.association;
  if (options.component) data.array.component = options.component;
  if (options.time.index || options.time.value) data.time = options.time;
  const RawLayout& raw = options.raw;
  if (raw.dimensions) data.raw.dimensions = raw.dimensions;
  if (raw.type) data.raw.type = raw.type;
  if (raw.components) data.raw.components = raw.components;
  if (raw.spacing) data.raw.spacing = raw.spacing;
  if (raw.is_big_endian) data.raw.is_big_endian = raw.is_big_endian;
  data.raw.header_bytes = options.header_bytes.value_or(data.raw.header_bytes);
}

/// `path` for a file in `directory`, see `data_seen_from`.
std::string seen_from(const fs::path& directory, const std::string& path) {
  if (path.empty() || is_builtin(path)) return path;
  const fs::path from = fs::weakly_canonical(fs::absolute(directory));
  const fs::path to = fs::weakly_canonical(fs::absolute(path));
  auto from_part = from.begin(), to_part = to.begin();
  std::ptrdiff_t shared = 0;
  for (; from_part != from.end() && to_part != to.end() && *from_part == *to_part; ++from_part, ++to_part) ++shared;
  return shared > 1 ? to.lexically_relative(from).string() : to.string();
}

/// Puts what `replace` makes of them in the place of the paths that a scene names beside its data.
template <class Replace>
void replace_paths(Scene& scene, const Replace& replace) {
  for (ClipShape& shape : scene.settings.clipping.shapes)
    if (auto* volume = std::get_if<ClipVolume>(&shape.shape)) volume->file = replace(volume->file);
  if (scene.multidimensional) scene.multidimensional->table_file = replace(scene.multidimensional->table_file);
  if (auto& environment = scene.settings.lighting.environment) environment->file = replace(environment->file);
}

}  // namespace

SceneInput load_scene_input(const InputOptions& options) {
  SceneInput input;
  const std::string& path = options.input;
  input.name = stem_of(path);
  std::error_code ignored;
  const bool holds_scene = !is_builtin(path) && !fs::is_directory(path, ignored);
  if (holds_scene && ending_of(path) == ".json") {
    input.scene = parse_scene(read_text(path), path);
  } else if (holds_scene && is_picture(path)) {
    input.picture = read_image_options(path);
    if (input.picture->scene.empty())
      throw Error(ErrorCode::kUnsupported,
                  "'" + path + "' holds no scene: only pictures that tetravox wrote can be drawn again");
    input.scene = parse_scene(input.picture->scene, "the scene in " + path);
  } else {
    input.scene.data.file = path;
  }
  SceneData& data = input.scene.data;
  const bool is_scene = holds_scene && (ending_of(path) == ".json" || is_picture(path));
  input.data_path = is_scene ? resolve(path, data.file) : path;
  if (is_scene) replace_paths(input.scene, [&](const std::string& file) { return resolve(path, file); });
  override_data(options, data);

  // PLOT3D comes as two files; the grid is the one that is opened.
  std::string solution = resolve(path, data.solution_file);
  if (!options.solution_file.empty()) solution = options.solution_file;
  if (!options.grid_file.empty()) {
    solution = input.data_path;
    input.data_path = options.grid_file;
  }
  input.read.array = data.array;
  input.read.others = other_arrays(input.scene);
  input.read.time = data.time;
  input.read.raw = data.raw;
  input.read.grid_file = solution;
  input.read.timeout = options.reader_timeout;
  return input;
}

Scene scene_seen_from(const SceneInput& input, const std::string& target) {
  const fs::path directory = fs::absolute(target).parent_path();
  Scene scene = input.scene;
  scene.data.file = seen_from(directory, input.data_path);
  scene.data.solution_file = seen_from(directory, input.read.grid_file);
  replace_paths(scene, [&](const std::string& path) { return seen_from(directory, path); });
  return scene;
}

}  // namespace tetravox::tool
