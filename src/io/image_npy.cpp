#include "src/io/image_npy.h"

#include "src/support/threads.h"

#include <bit>
#include <cstddef>
#include <string>

namespace tetravox::io {

static_assert(std::endian::native == std::endian::little, "the header says little-endian");

void write_npy_header(OutputFile& file, const std::string& type, const std::vector<std::size_t>& shape) {
  // Magic, version 1.0, length, a Python dictionary padded with spaces to a multiple of 64 bytes.
  std::string dictionary = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (";
  for (std::size_t i = 0; i < shape.size(); ++i)
    dictionary += (i == 0 ? "" : ", ") + std::to_string(shape[i]) + (shape.size() == 1 ? "," : "");
  dictionary += "), }";
  const std::size_t fixed = 10;
  const std::size_t total = (fixed + dictionary.size() + 1 + 63) / 64 * 64;
  dictionary.append(total - fixed - dictionary.size() - 1, ' ');
  dictionary.push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(dictionary.size() & 0xFFu));
  header.push_back(static_cast<char>(dictionary.size() >> 8));
  header += dictionary;
  file.write(header.data(), header.size());
}

void write_npy(OutputFile& file, const Image& image, const Progress& progress) {
  write_npy_header(file, "<f4", {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width), 4});
  const std::size_t row = 4 * static_cast<std::size_t>(image.width);
  for (int y = 0; y < image.height; ++y) {
    support::throw_if_cancelled(progress);
    file.write(image.pixel(0, y), row * sizeof(float));
  }
}

void write_depth_npy(OutputFile& file, const Image& image) {
  write_npy_header(file, "<f4", {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width)});
  file.write(image.depth.data(), image.depth.size() * sizeof(float));
}

}  // namespace tetravox::io
