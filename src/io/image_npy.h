#pragma once

/// NumPy arrays: float32 [height][width][4], C order, premultiplied.

#include "src/io/output_file.h"

#include "tetravox/image.h"
#include "tetravox/progress.h"

namespace tetravox::io {

/// Writes the picture's floats as they are, row 0 first. @throws Error: kCannotWrite, kCancelled.
void write_npy(OutputFile& file, const Image& image, const Progress& progress);

}  // namespace tetravox::io
