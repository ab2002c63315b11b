#pragma once

/// PNG pictures by libpng, with the scene as compressed UTF-8 text (iTXt) under the keyword "tetravox scene".

#include "src/io/image_pixels.h"
#include "src/io/output_file.h"

#include "tetravox/image.h"
#include "tetravox/io.h"
#include "tetravox/progress.h"

#include <string>

namespace tetravox::io {

/// Writes the picture, row 0 at the top. Samples are rounded to nearest and clamped; what is not a number counts as 0.
/// @throws Error: kCannotWrite, kCancelled.
void write_png(OutputFile& file, const Image& image, const WriteOptions& options, const Progress& progress);

/// What a PNG says about how it was written; the scene is empty where there is none.
/// @throws Error: kFileNotFound, kBadFile for what libpng cannot read as far as the first pixel.
WriteOptions read_png_options(const std::string& path);

/// See `read_pixels`.
Pixels read_png_pixels(const std::string& path, std::size_t most);

}  // namespace tetravox::io
