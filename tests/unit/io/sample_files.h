#pragma once

/// Small files of every format, made at run time, that all hold the same mesh: two unit cubes side by side in x, twelve
/// points in rows along x, then y, then z. Point data S = 0, 1, .. 11; cell data C = 5, 7.

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace tetravox::test {

/// A directory that is there as long as this object.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory();
  const std::filesystem::path& path() const { return path_; }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

struct Sample {
  std::string name;
  std::string main_file;             ///< what is given to read_dataset, below the directory
  std::string solution_file;         ///< PLOT3D
  std::vector<std::string> victims;  ///< files worth damaging
  std::function<void(const std::filesystem::path&)> write;
  std::string point_array = "S";  ///< empty: the format has none
  bool has_cell_data = true;
  int copies = 1;  ///< how often the mesh is in the file
};

/// How GoogleTest prints a sample.
inline void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.name; }

/// One sample for each format that can be made here.
const std::vector<Sample>& samples();

/// @throws std::runtime_error.
std::string read_text(const std::string& path);
void write_text(const std::filesystem::path& path, const std::string& text);

/// The mesh as a text VTU file; `extra_cell_data` goes into its CellData, `shift` is added to x.
std::string vtu_text(const std::string& extra_cell_data = {}, double shift = 0.0);

}  // namespace tetravox::test
