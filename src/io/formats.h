#pragma once

/// Which format a file is in: by its content where that tells, otherwise by its ending.

#include <string>
#include <string_view>
#include <vector>

namespace tetravox::io {

enum class Format {
  kVtu,
  kVts,
  kVtr,
  kVti,
  kParallelXml,   ///< PVTU, PVTS: lists pieces
  kParallelGrid,  ///< PVTI, PVTR: lists pieces of one grid
  kMultiBlock,    ///< VTM
  kPvd,
  kLegacyVtk,
  kVtkHdf,
  kExodus,
  kCgns,
  kEnSight,
  kOpenFoam,
  kUcd,
  kPlot3d,
  kNrrd,
  kMetaImage,
  kNifti,
  kSlc,
  kDicom,
  kTiff,
  kMrc,
  kRaw,        ///< values only: see raw_file.h
  kHierarchy,  ///< AMR: understood, not drawn
  kSurface,    ///< understood, nothing to draw
};

/// The format's full name, for people.
std::string format_name(Format format);

/// The format of the file or directory (an OpenFOAM case, or slices: DICOM, TIFF) at `path`. `has_solution`: a PLOT3D
/// solution file was named too.
/// @throws Error: kFileNotFound (also without permission), kBadFile (empty, or a special file), kUnsupported with what
/// can be read.
Format detect_format(const std::string& path, bool has_solution);

/// Refuses what is no file with something in it that can be read.
/// @throws Error: kFileNotFound (also without permission), kBadFile (empty, or a special file).
void check_file(const std::string& path);

/// Files of a directory in the order in which people count ("slice2.tif" before "slice10.tif"), below it; no
/// directories, no hidden files.
std::vector<std::string> list_files(const std::string& directory);

/// Whether the bytes begin as a DICOM file does.
bool is_dicom_head(std::string_view head);
/// The text with small letters.
std::string lower_case(std::string_view text);

/// Whether the name has this ending, in capitals or not.
bool has_ending(const std::string& path, std::string_view ending);

}  // namespace tetravox::io
