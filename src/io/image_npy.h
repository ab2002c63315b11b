#pragma once

/// NumPy arrays, C order, little-endian. Pictures are float32 [height][width][4], premultiplied.

#include "src/io/output_file.h"

#include "tetravox/image.h"
#include "tetravox/progress.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tetravox::io {

/// Writes what stands before the numbers. `type` in NumPy's words ("<f4"). @throws Error (kCannotWrite).
void write_npy_header(OutputFile& file, const std::string& type, const std::vector<std::size_t>& shape);

/// Writes the picture's floats as they are, row 0 first. @throws Error: kCannotWrite, kCancelled.
void write_npy(OutputFile& file, const Image& image, const Progress& progress);

/// Writes `Image::depth` as float32 [height][width]. @throws Error (kCannotWrite).
void write_depth_npy(OutputFile& file, const Image& image);

}  // namespace tetravox::io
