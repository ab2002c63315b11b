#include "src/io/reader/zip_archive.h"

#include "src/io/reader/blocks.h"
#include "src/io/reader/file_checks.h"

#include <zlib.h>

#include <string_view>

namespace tetravox::io {

namespace {

constexpr std::size_t kEndBytes = 22, kEntryBytes = 46, kLocalBytes = 30;
/// Deflate makes at most 1032 bytes of one.
constexpr std::uint64_t kMostInflation = 1040;

std::uint32_t number(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// The part of the archive, which must be in it.
std::string_view part(std::string_view archive, std::size_t at, std::size_t size, const std::string& path) {
  if (at > archive.size() || size > archive.size() - at) fail_file(path, "the archive ends too early");
  return archive.substr(at, size);
}

/// The record that ends an archive; a comment may follow it.
std::string_view find_end(std::string_view archive, const std::string& path) {
  using namespace std::string_view_literals;
  const std::size_t at = archive.rfind("PK\5\6"sv);
  if (at == std::string_view::npos || archive.size() - at < kEndBytes) fail_file(path, "the archive has no end");
  return archive.substr(at, kEndBytes);
}

std::string inflate_entry(std::string_view packed, std::size_t size, const std::string& path) {
  if (size / kMostInflation > packed.size()) fail_file(path, "an entry of the archive is too short");
  std::string out(size, '\0');
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  const int result = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (result != Z_STREAM_END || stream.avail_out != 0) fail_file(path, "an entry of the archive is damaged");
  return out;
}

ArchiveFile read_entry(std::string_view archive, std::string_view entry, const std::string& path) {
  const std::uint32_t flags = number(entry, 8, 2), method = number(entry, 10, 2), checksum = number(entry, 16, 4);
  const std::uint32_t packed_size = number(entry, 20, 4), size = number(entry, 24, 4), at = number(entry, 42, 4);
  if ((flags & 1u) != 0 || (method != 0 && method != 8) || size == 0xFFFFFFFFu || at == 0xFFFFFFFFu)
    throw Error(ErrorCode::kUnsupported,
                "'" + path + "' is encrypted, larger than 4 GiB or compressed in an unusual way: unpack it");
  const std::string_view local = part(archive, at, kLocalBytes, path);
  const std::size_t begin = at + kLocalBytes + number(local, 26, 2) + number(local, 28, 2);
  const std::string_view packed = part(archive, begin, packed_size, path);
  ArchiveFile file;
  file.name = entry.substr(kEntryBytes, number(entry, 28, 2));
  if (method == 0 && packed_size != size) fail_file(path, "an entry of the archive is damaged");
  file.bytes = method == 0 ? std::string(packed) : inflate_entry(packed, size, path);
  const uLong sum = crc32_z(0, reinterpret_cast<const Bytef*>(file.bytes.data()), file.bytes.size());
  if (sum != checksum) fail_file(path, "an entry of the archive is damaged");
  return file;
}

}  // namespace

std::vector<ArchiveFile> read_zip(const std::string& path) {
  using namespace std::string_view_literals;
  const MappedFile file(path);
  const std::string_view archive = file.text();
  const std::string_view end = find_end(archive, path);
  const std::uint32_t count = number(end, 10, 2);
  std::size_t at = number(end, 16, 4);
  std::vector<ArchiveFile> files;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string_view head = part(archive, at, kEntryBytes, path);
    if (!head.starts_with("PK\1\2"sv)) fail_file(path, "the directory of the archive is damaged");
    const std::size_t name = number(head, 28, 2);
    const std::string_view entry = part(archive, at, kEntryBytes + name, path);
    if (!entry.ends_with('/')) files.push_back(read_entry(archive, entry, path));
    at += kEntryBytes + name + number(head, 30, 2) + number(head, 32, 2);
  }
  return files;
}

}  // namespace tetravox::io
