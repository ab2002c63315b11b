#pragma once

/// Pictures read as tables of a function: colours that are not premultiplied, and opacities.

#include <cstddef>
#include <string>
#include <vector>

namespace tetravox::io {

/// [height][width][4] in [0, 1], row 0 at the top.
struct TableImage {
  std::size_t width = 0, height = 0;
  std::vector<float> rgba;
};

/// Reads a PNG of any kind that has alpha, of 2 to `largest` pixels a side.
/// @throws Error that names the file: kFileNotFound, kBadFile; kUnsupported without alpha or for other sizes.
TableImage read_png_table(const std::string& path, std::size_t largest);

/// Reads an EXR with the channels R, G, B and A, premultiplied; where A is 0 colours are taken as they stand. Throws as
/// above.
TableImage read_exr_table(const std::string& path, std::size_t largest);

/// @throws Error (kUnsupported).
void require_table_size(const std::string& path, std::size_t width, std::size_t height, std::size_t largest);

}  // namespace tetravox::io
