#include "tests/common/image_file.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

namespace tetravox::tests {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw std::runtime_error(path.string() + ": " + what);
}

Image read_npy(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  char start[10] = {};
  if (!file.read(start, sizeof start) || std::memcmp(start, "\x93NUMPY\x01", 7) != 0)
    fail(path, "is not NPY version 1");
  const unsigned length = static_cast<unsigned char>(start[8]) + 256u * static_cast<unsigned char>(start[9]);
  std::string header(length, ' ');
  file.read(header.data(), static_cast<std::streamsize>(length));
  Image image;
  const std::size_t shape = header.find("'shape': (");
  if (header.find("'<f4'") == std::string::npos || header.find("'fortran_order': False") == std::string::npos ||
      shape == std::string::npos ||
      std::sscanf(header.c_str() + shape, "'shape': (%d, %d, 4)", &image.height, &image.width) != 2)
    fail(path, "is not float32 [height][width][4]: " + header);
  image.pixels.resize(4 * static_cast<std::size_t>(image.width) * image.height);
  const auto bytes = static_cast<std::streamsize>(image.pixels.size() * sizeof(float));
  if (!file.read(reinterpret_cast<char*>(image.pixels.data()), bytes)) fail(path, "is too short");
  return image;
}

void write_npy(const std::filesystem::path& path, const Image& image) {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(image.height) + ", " +
                       std::to_string(image.width) + ", 4), }";
  header.resize((header.size() + 11 + 63) / 64 * 64 - 11, ' ');
  header += '\n';
  std::ofstream file(path, std::ios::binary);
  file.write("\x93NUMPY\x01\x00", 8);
  file.put(static_cast<char>(header.size() % 256)).put(static_cast<char>(header.size() / 256));
  file << header;
  file.write(reinterpret_cast<const char*>(image.pixels.data()),
             static_cast<std::streamsize>(image.pixels.size() * sizeof(float)));
  if (!file) fail(path, "cannot be written");
}

Image read_png(const std::filesystem::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str())) fail(path, png.message);
  png.format = PNG_FORMAT_RGBA;
  std::vector<png_byte> bytes(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr)) fail(path, png.message);
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.pixels.resize(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const float alpha = static_cast<float>(bytes[i - i % 4 + 3]) / 255.0f;
    image.pixels[i] = i % 4 == 3 ? alpha : alpha * static_cast<float>(bytes[i]) / 255.0f;
  }
  return image;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  std::vector<png_byte> bytes;
  bytes.reserve(image.pixels.size() / 4 * 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (i % 4 == 3) continue;
    const float value = std::isfinite(image.pixels[i]) ? std::clamp(image.pixels[i], 0.0f, 1.0f) : 1.0f;
    bytes.push_back(static_cast<png_byte>(std::lround(255.0f * value)));
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&png, path.c_str(), 0, bytes.data(), 0, nullptr)) fail(path, png.message);
}

}  // namespace

Image read_picture(const std::filesystem::path& path) {
  if (path.extension() == ".npy") return read_npy(path);
  if (path.extension() == ".png") return read_png(path);
  fail(path, "has an ending that is not known: use .npy or .png");
}

void write_picture(const std::filesystem::path& path, const Image& image) {
  if (path.extension() == ".npy") return write_npy(path, image);
  if (path.extension() == ".png") return write_png(path, image);
  fail(path, "has an ending that is not known: use .npy or .png");
}

Image make_difference_picture(const Image& first, const Image& second, float gain) {
  Image result{first.width, first.height, std::vector<float>(first.pixels.size(), 1.0f)};
  if (first.pixels.size() != second.pixels.size() || first.width != second.width) return result;
  for (std::size_t i = 0; i < first.pixels.size(); i += 4) {
    const float alpha = std::abs(first.pixels[i + 3] - second.pixels[i + 3]);
    for (std::size_t k = i; k < i + 3; ++k)
      result.pixels[k] = gain * std::max(alpha, std::abs(first.pixels[k] - second.pixels[k]));
  }
  return result;
}

}  // namespace tetravox::tests
