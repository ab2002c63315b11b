#pragma once

/// Which format a file is in: by its content where that tells, otherwise by its ending.

#include <string>

namespace tetravox::io {

enum class Format {
  kVtu,
  kVts,
  kVtr,
  kParallelXml,  ///< PVTU, PVTS, PVTR: lists pieces
  kMultiBlock,   ///< VTM
  kPvd,
  kLegacyVtk,
  kVtkHdf,
  kExodus,
  kCgns,
  kEnSight,
  kOpenFoam,
  kUcd,
  kPlot3d,
  kRegularGrid,  ///< understood, not drawn
  kSurface,      ///< understood, nothing to draw
};

/// The format's full name, for people.
std::string format_name(Format format);

/// The format of the file (or OpenFOAM case directory) at `path`. `has_solution`: a PLOT3D solution file was named too.
/// @throws Error: kFileNotFound (also without permission), kBadFile (empty, or a special file), kUnsupported with what
/// can be read.
Format detect_format(const std::string& path, bool has_solution);

}  // namespace tetravox::io
