#pragma once

#include <string>
#include <vector>

namespace tetravox::io {

struct ArchiveFile {
  std::string name;
  std::string bytes;
};

/// The files of a ZIP archive ("APPNOTE.TXT - .ZIP File Format Specification" 6.3), stored or deflated, in the order of
/// its directory.
/// @throws Error: kBadFile for a damaged archive (checksums are compared), kUnsupported for encryption, other
/// compression and ZIP64.
std::vector<ArchiveFile> read_zip(const std::string& path);

}  // namespace tetravox::io
