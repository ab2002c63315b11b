#pragma once

/// Bytes of the files that hold a volume, one after the other, inflated where they are compressed. A file that ends
/// before it should is an error, never zeros.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tetravox::io {

/// Where a volume's bytes are.
struct VolumeFiles {
  std::vector<std::string> paths;   ///< each holds the same number of bytes of the volume
  std::uint64_t offset = 0;         ///< bytes of each file, as it stands, before its part of the volume
  bool is_at_end = false;           ///< the part is the file's end instead, whatever comes before
  bool is_compressed = false;       ///< zlib or gzip, from `offset` on
  std::uint64_t inflated_skip = 0;  ///< bytes after inflating, before the part of the volume
};

class VolumeStream {
 public:
  /// @throws Error (kBadFile) where `bytes` are not in the files, as far as sizes tell.
  VolumeStream(VolumeFiles files, std::uint64_t bytes);
  ~VolumeStream();
  /// The next bytes. @throws Error (kBadFile) where there are fewer, or where they are damaged.
  void read(std::span<std::byte> out);
  void skip(std::uint64_t bytes);
  /// Bytes that follow the volume in its last file and are not a part of it.
  std::uint64_t count_rest();

 private:
  class Source;
  class PlainSource;
  class InflatingSource;
  void open_next();

  VolumeFiles files_;
  std::uint64_t bytes_per_file_ = 0;
  std::uint64_t left_ = 0;  ///< of the part in the open file
  std::size_t next_ = 0;
  std::unique_ptr<Source> source_;
};

/// The first bytes of a file, inflated where it is gzip; fewer where it is shorter.
std::string read_head(const std::string& path, std::size_t count);

/// Whether the file begins as gzip does.
bool is_gzip(const std::string& path);

/// Bytes of a file. @throws Error (kBadFile) where there is none.
std::uint64_t file_size(const std::string& path);

}  // namespace tetravox::io
