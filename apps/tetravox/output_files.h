#pragma once

/// The files of one run: all of them are written, or none remains.

#include <string>
#include <vector>

namespace tetravox::tool {

/// @throws Error (kCannotWrite) before any long work where a file of this name could not be written.
void require_writable(const std::string& path);

/// Removes the new files of a run that fails half way. Files that were there before stay.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Calls `write(path)`, which makes the file.
  template <class Write>
  void write(const std::string& path, const Write& write) {
    const bool is_new = !exists(path);
    write(path);
    if (is_new) written_.push_back(path);
  }
  /// Everything is written: nothing is removed any more.
  void keep() { written_.clear(); }

 private:
  static bool exists(const std::string& path);

  std::vector<std::string> written_;
};

}  // namespace tetravox::tool
