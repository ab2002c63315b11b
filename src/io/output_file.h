#pragma once

/// Output files that appear under their name only when they are complete.

#include <cstddef>
#include <cstdio>
#include <string>

namespace tetravox::io {

/// A file being written. Until `commit` its bytes have no name (or, where the file system cannot do that, a temporary
/// name in the same directory), so that neither an error nor a kill leaves half a file behind. A symbolic link is
/// followed; a file that is replaced keeps its permissions.
class OutputFile {
 public:
  /// @throws Error (kCannotWrite) when the directory is missing or `path` may not be written.
  explicit OutputFile(const std::string& path);
  /// Removes what was not committed.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// False where the bytes could not be written; the reason is kept for `fail`.
  bool try_write(const void* bytes, std::size_t count) noexcept;
  /// @throws Error (kCannotWrite).
  void write(const void* bytes, std::size_t count);
  /// Position in the file, bytes; for formats that go back. @throws Error (kCannotWrite).
  std::size_t tell();
  void seek(std::size_t position);

  /// Gives the file its name. @throws Error (kCannotWrite).
  void commit();

  bool has_failed() const noexcept { return error_ != 0; }
  /// @throws Error (kCannotWrite) that names the file and the reason of the first failure.
  [[noreturn]] void fail() const;

 private:
  void open();
  std::string temporary_name(const std::string& directory) const;

  std::string path_;       ///< as the user gave it, for messages
  std::string target_;     ///< with a symbolic link resolved
  std::string directory_;  ///< of the target
  std::string temporary_;  ///< empty while the file has no name
  int permissions_ = -1;   ///< of the file that is replaced
  int error_ = 0;          ///< errno of the first failure
  std::FILE* file_ = nullptr;
};

}  // namespace tetravox::io
