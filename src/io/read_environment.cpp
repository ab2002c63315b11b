/// Surroundings from files: one equirectangular picture, or six faces of a cube.

#include "src/io/image_pixels.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <system_error>

namespace tetravox {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 6> kFaceNames{"px", "nx", "py", "ny", "pz", "nz"};

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// Pixels that can be radiance: filters of some programs leave a little less than nothing beside bright places.
io::Pixels read_radiance(const std::string& path) {
  io::Pixels pixels = io::read_pixels(path, kMostEnvironmentTexels);
  for (std::size_t i = 0; i < pixels.colors.size(); ++i) {
    float& value = pixels.colors[i];
    if (!(value <= kLargestRadiance))
      throw Error(ErrorCode::kBadFile, "'" + path + "' has the value " + std::to_string(value) + " at column " +
                                           std::to_string(i / 3 % pixels.width) + ", row " +
                                           std::to_string(i / 3 / pixels.width) + ": radiance is a number up to 1e9");
    value = std::max(value, 0.0f);
  }
  return pixels;
}

Environment read_equirectangular(const std::string& path) {
  io::Pixels pixels = read_radiance(path);
  if (pixels.width != 2LL * pixels.height)
    throw Error(ErrorCode::kUnsupported, "'" + path + "' has " + std::to_string(pixels.width) + " x " +
                                             std::to_string(pixels.height) +
                                             " pixels: surroundings in one picture are twice as wide as high");
  return {EnvironmentLayout::kEquirectangular, pixels.width, pixels.height, std::move(pixels.colors)};
}

/// The file of a face: in a directory, or named by a pattern.
std::string find_face(const std::string& path, bool is_directory, const std::string& face) {
  if (!is_directory) {
    std::string file = path;
    return file.replace(path.rfind('*'), 1, face);
  }
  for (const char* ending : {".exr", ".png"})
    if (const std::string file = (fs::path(path) / (face + ending)).string(); exists(file)) return file;
  throw Error(ErrorCode::kFileNotFound, "the directory '" + path + "' holds neither " + face + ".exr nor " + face +
                                            ".png: surroundings are six faces, px, nx, py, ny, pz and nz");
}

Environment read_cube(const std::string& path, bool is_directory) {
  Environment environment;
  environment.layout = EnvironmentLayout::kCube;
  for (const char* face : kFaceNames) {
    const std::string file = find_face(path, is_directory, face);
    const io::Pixels pixels = read_radiance(file);
    if (environment.radiance.empty()) environment.width = environment.height = pixels.width;
    if (pixels.width != environment.width || pixels.height != environment.height)
      throw Error(ErrorCode::kBadFile, "'" + file + "' has " + std::to_string(pixels.width) + " x " +
                                           std::to_string(pixels.height) +
                                           " pixels: the faces of a cube are square, and all of one size");
    if (6LL * pixels.width * pixels.height > kMostEnvironmentTexels)
      throw Error(ErrorCode::kUnsupported, "the six faces of '" + path + "' have more than " +
                                               std::to_string(kMostEnvironmentTexels) + " pixels: make them smaller");
    environment.radiance.insert(environment.radiance.end(), pixels.colors.begin(), pixels.colors.end());
  }
  return environment;
}

}  // namespace

Environment read_environment(const std::string& path) {
  if (path.starts_with("builtin:")) return make_builtin_environment(path);
  std::error_code ignored;
  if (!fs::exists(path, ignored))
    for (const auto& [name, description] : builtin_environment_names())
      if (path == name)
        throw Error(ErrorCode::kFileNotFound,
                    "there is no file '" + path + "': the embedded surroundings are 'builtin:" + path + "'");
  if (fs::is_directory(path, ignored)) return read_cube(path, true);
  if (path.find('*') != std::string::npos && !exists(path)) return read_cube(path, false);
  return read_equirectangular(path);
}

}  // namespace tetravox
