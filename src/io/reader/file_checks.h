#pragma once

/// Checks of whole files for damage that VTK's readers pass over in silence.

#include <string>

namespace tetravox::io {

/// A netCDF classic file (Exodus) is as long as its header says; the netCDF library takes zeros for what is missing.
/// Other files pass.
/// @throws Error (kBadFile).
void check_netcdf_length(const std::string& path);

/// Every array in the raw appended data of a VTK XML file ends before that data does, and the file is closed; VTK takes
/// whatever stands in memory for what is missing. Files without raw appended data pass.
/// @throws Error (kBadFile).
void check_appended_data(const std::string& path);

/// The whole file in memory.
/// @throws Error (kBadFile, kFileNotFound).
std::string read_whole_file(const std::string& path);

}  // namespace tetravox::io
