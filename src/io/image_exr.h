#pragma once

/// OpenEXR pictures: premultiplied float channels R, G, B, A, the scene in the string attribute "tetravox_scene".

#include "src/io/image_pixels.h"
#include "src/io/output_file.h"

#include "tetravox/image.h"
#include "tetravox/io.h"
#include "tetravox/progress.h"

#include <string>

namespace tetravox::io {

/// Writes the picture, row 0 at the top (increasing y), without loss. @throws Error: kCannotWrite, kCancelled.
void write_exr(OutputFile& file, const Image& image, const WriteOptions& options, const Progress& progress);

/// Writes `Image::depth` as the channel Z. @throws Error (kCannotWrite).
void write_depth_exr(OutputFile& file, const Image& image);

/// The scene in an EXR's first header, empty where there is none. Reads the header only, by a parser of its own that
/// believes no length in the file.
/// @throws Error: kFileNotFound, kBadFile.
std::string read_exr_scene(const std::string& path);

/// See `read_pixels`.
Pixels read_exr_pixels(const std::string& path, std::size_t most);

}  // namespace tetravox::io
