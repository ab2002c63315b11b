#pragma once

/// RAW files: the values of a grid and nothing else. Their name or options say how they are to be understood. They need
/// no reader process: there is nothing to parse.

#include "tetravox/dataset.h"
#include "tetravox/progress.h"
#include "tetravox/scene.h"

#include <string>

namespace tetravox::io {

/// What the name of a file says by the convention of the Open SciVis Datasets (Klacansky 2017):
/// "name_256x256x256_uint8.raw", also with a spacing, "name_103x94x161_1x1x1.5_uint8.raw". Empty where it says nothing.
RawLayout parse_raw_name(const std::string& path);

/// Whether `path` is to be read as a RAW file: it ends in ".raw", or dimensions are given. No directory is.
bool is_raw_file(const std::string& path, const RawLayout& layout);

/// @throws Error (kInvalidArgument) where `layout` says anything: for `path`, which is no RAW file.
void require_no_layout(const RawLayout& layout, const std::string& path);

/// Reads a RAW file; what `layout` leaves open is taken from its name, then little endian, one component, spacing 1.
/// The file is mapped, and viewed as it is, where values are in this machine's byte order and lie on multiples of their
/// size; otherwise it is read. A mapped file shows what other programs write to it; what they cut off becomes 0.
/// The one array is called "values"; the summary is complete.
/// @throws Error that names the file: kFileNotFound; kBadFile for a file of another size than its layout says, or that
/// is empty; kInvalidArgument for a layout that is incomplete or makes no sense; kNothingToDraw for one without volume;
/// kOutOfMemory; kCancelled.
Dataset read_raw_file(const std::string& path, const RawLayout& layout, const Progress& progress);

}  // namespace tetravox::io
