#pragma once

/// Pixels of pictures that others wrote.

#include <cstddef>
#include <string>
#include <vector>

namespace tetravox::io {

/// Red, green, blue without alpha; row 0 at the top.
struct Pixels {
  int width = 0, height = 0;
  std::vector<float> colors;  ///< [height][width][3]
};

/// Reads a .png or .exr of at most `most` pixels. PNG samples of any depth and kind become 0 to 1, as displayed. EXR
/// channels R, G and B, or Y alone, are taken as they are.
/// @throws Error that names the file: kFileNotFound, kBadFile, kUnsupported (too large; channels), kInvalidArgument
/// (another ending), kOutOfMemory.
Pixels read_pixels(const std::string& path, std::size_t most);

/// Refuses sizes that cannot be, or are more than `most` pixels; makes room for the others.
/// @throws Error (kBadFile, kUnsupported, kOutOfMemory).
Pixels make_pixels(const std::string& path, long long width, long long height, std::size_t most);

}  // namespace tetravox::io
