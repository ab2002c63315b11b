#pragma once

/// Picture files for tests, read and written without tetravox's own io.

#include "tetravox/image.h"

#include <filesystem>

namespace tetravox::tests {

/// Reads NPY (float32 [height][width][4], little endian, C order) or 8-bit PNG by the ending; PNG values are
/// premultiplied on the way in.
/// @throws std::runtime_error that names the file.
Image read_picture(const std::filesystem::path& path);

/// Writes NPY as it is, or an 8-bit PNG over a black background.
/// @throws std::runtime_error that names the file.
void write_picture(const std::filesystem::path& path, const Image& image);

/// |first - second| times `gain` in each colour, opaque; opacity's difference is added to all three.
Image make_difference_picture(const Image& first, const Image& second, float gain);

}  // namespace tetravox::tests
