#pragma once

/// Checks of whole files for damage that VTK's readers pass over in silence.

#include <string>
#include <string_view>

namespace tetravox::io {

/// A netCDF classic file (Exodus) is as long as its header says; the netCDF library takes zeros for what is missing.
/// Other files pass.
/// @throws Error (kBadFile).
void check_netcdf_length(const std::string& path);

/// Every array of a VTK XML file (VTU, VTS, VTR) has as many values as its piece says, and its data lie inside the
/// file; the pieces of a structured grid fill its extent. VTK takes whatever stands in memory for what is missing.
/// @throws Error (kBadFile).
void check_xml_arrays(const std::string& path);

/// The files of an EnSight case hold all values they promise at a time. Files with Fortran records and files with
/// several steps in one pass unseen.
/// @throws Error (kBadFile).
void check_ensight_files(const std::string& path, double time);

/// A file mapped for reading.
class MappedFile {
 public:
  /// @throws Error (kBadFile) for a file that cannot be opened or is empty.
  explicit MappedFile(const std::string& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();
  std::string_view text() const { return text_; }

 private:
  std::string_view text_;
};

/// The whole file in memory.
/// @throws Error (kBadFile, kFileNotFound).
std::string read_whole_file(const std::string& path);

}  // namespace tetravox::io
