#include "src/io/image_exr.h"
#include "src/io/image_npy.h"
#include "src/io/image_pixels.h"
#include "src/io/image_png.h"
#include "src/io/output_file.h"

#include "src/support/memory.h"

#include "tetravox/error.h"
#include "tetravox/io.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>

namespace tetravox {
namespace {

/// The ending of a path in lower case, with its dot.
std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return ending;
}

void validate_image(const Image& image, const WriteOptions& options) {
  const bool has_size = image.width > 0 && image.height > 0;
  const std::size_t wanted = has_size ? 4 * static_cast<std::size_t>(image.width) * image.height : 0;
  if (!has_size || image.pixels.size() != wanted)
    throw Error(ErrorCode::kInvalidArgument, "a picture of " + std::to_string(image.width) + " x " +
                                                 std::to_string(image.height) + " pixels needs " +
                                                 std::to_string(wanted) + " floats and has " +
                                                 std::to_string(image.pixels.size()));
  if (options.bit_depth != 8 && options.bit_depth != 16)
    throw Error(ErrorCode::kInvalidArgument,
                "a PNG has 8 or 16 bits a channel, not " + std::to_string(options.bit_depth));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> image_writer_names() {
  return {{".png", "8 or 16 bits, over the background or with alpha; holds the scene"},
          {".exr", "float, premultiplied; holds the scene"},
          {".npy", "float32 [height][width][4], premultiplied"}};
}

void write_image(const std::string& path, const Image& image, const WriteOptions& options, const Progress& progress) {
  validate_image(image, options);
  const std::string ending = ending_of(path);
  if (ending != ".png" && ending != ".exr" && ending != ".npy")
    throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': pictures end in .png, .exr or .npy" +
                                                 (ending.empty() ? "; this name has no ending" : ""));
  io::OutputFile file(path);
  if (ending == ".png") io::write_png(file, image, options, progress);
  if (ending == ".exr") io::write_exr(file, image, options, progress);
  if (ending == ".npy") io::write_npy(file, image, progress);
  file.commit();
}

void write_depth(const std::string& path, const Image& image) {
  if (image.depth.empty() || image.depth.size() != static_cast<std::size_t>(image.width) * image.height)
    throw Error(ErrorCode::kInvalidArgument, "this picture has no depth: ask for it before drawing");
  const std::string ending = ending_of(path);
  if (ending != ".exr" && ending != ".npy")
    throw Error(ErrorCode::kInvalidArgument, "cannot write '" + path + "': depths end in .exr or .npy");
  io::OutputFile file(path);
  if (ending == ".exr") io::write_depth_exr(file, image);
  if (ending == ".npy") io::write_depth_npy(file, image);
  file.commit();
}

WriteOptions read_image_options(const std::string& path) {
  const std::string ending = ending_of(path);
  if (ending == ".png") return io::read_png_options(path);
  if (ending != ".exr")
    throw Error(ErrorCode::kInvalidArgument, "'" + path + "': only .png and .exr pictures hold a scene");
  WriteOptions options;
  options.scene = io::read_exr_scene(path);
  return options;
}

io::Pixels io::make_pixels(const std::string& path, long long width, long long height, std::size_t most) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width < 1 || height < 1) throw Error(ErrorCode::kBadFile, "'" + path + "' says that it has " + size);
  const auto largest = static_cast<long long>(most);
  if (width > largest || height > largest / width)
    throw Error(ErrorCode::kUnsupported,
                "'" + path + "' has " + size + ": at most " + std::to_string(most) + " are read, so make it smaller");
  Pixels pixels{static_cast<int>(width), static_cast<int>(height), {}};
  const std::size_t count = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  support::require_memory(2 * count * sizeof(float), "the pixels of '" + path + "'");
  pixels.colors.resize(count);
  return pixels;
}

io::Pixels io::read_pixels(const std::string& path, std::size_t most) {
  const std::string ending = ending_of(path);
  if (ending == ".png") return read_png_pixels(path, most);
  if (ending == ".exr") return read_exr_pixels(path, most);
  throw Error(ErrorCode::kInvalidArgument, "'" + path + "' ends in neither .png nor .exr");
}

std::string read_image_scene(const std::string& path) { return read_image_options(path).scene; }

void write_text_file(const std::string& path, const std::string& text) {
  io::OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

void write_array(const std::string& path, std::span<const double> values, const std::vector<std::size_t>& shape) {
  std::size_t wanted = 1;
  for (const std::size_t length : shape) wanted *= length;
  if (shape.empty() || wanted != values.size())
    throw Error(ErrorCode::kInvalidArgument, "an array of this shape needs " + std::to_string(wanted) +
                                                 " numbers and has " + std::to_string(values.size()));
  io::OutputFile file(path);
  io::write_npy_header(file, "<f8", shape);
  file.write(values.data(), values.size_bytes());
  file.commit();
}

std::uint64_t available_memory() { return support::available_memory(); }

}  // namespace tetravox
