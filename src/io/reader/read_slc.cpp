// SLC, VolVis' format of bytes: a header in text, a thumbnail, and slices, each raw or as run lengths. VTK 9.1 does not
// notice when a slice holds fewer values than it should.

#include "src/io/reader/file_checks.h"
#include "src/io/reader/raw_volume.h"
#include "src/io/reader/status.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

namespace tetravox::io {

namespace {

/// Takes words and bytes off the file.
class Scanner {
 public:
  explicit Scanner(const std::string& path) : path_(path), file_(path), text_(file_.text()) {}

  template <class Number>
  Number number() {
    while (!text_.empty() && std::isspace(static_cast<unsigned char>(text_.front()))) text_.remove_prefix(1);
    Number value{};
    const auto [end, error] =
        std::from_chars(text_.data(), text_.data() + std::min<std::size_t>(text_.size(), 64), value);
    if (error != std::errc()) fail_file(path_, "a number of its header is missing");
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return value;
  }
  std::uint64_t count() {
    const auto value = number<std::int64_t>();
    if (value < 0) fail_file(path_, "a number of its header is negative");
    return static_cast<std::uint64_t>(value);
  }
  /// The X that parts text from bytes.
  void mark() {
    const std::size_t at = text_.find_first_not_of(" \t\r\n");
    if (at == std::string_view::npos || text_[at] != 'X') fail_file(path_, "the mark before its data is missing");
    text_.remove_prefix(at + 1);
  }
  std::string_view bytes(std::uint64_t count) {
    if (count > text_.size()) fail_file(path_, "it ends before its last slice does");
    const std::string_view out = text_.substr(0, static_cast<std::size_t>(count));
    text_.remove_prefix(static_cast<std::size_t>(count));
    return out;
  }
  std::size_t left() const { return text_.size(); }

 private:
  const std::string& path_;
  MappedFile file_;
  std::string_view text_;
};

/// Decodes run lengths: a byte whose lower seven bits count, with the eighth set, so many bytes as they are, otherwise
/// the next byte so many times; a count of 0 ends. False unless they end where `in` does and make `out`, or all but its
/// last byte, which an encoder that was in use left out: it is taken as the one before.
bool decode_runs(std::string_view in, std::span<std::byte> out) {
  std::size_t at = 0, done = 0;
  bool has_end = false;
  while (at < in.size() && !has_end) {
    const auto code = static_cast<unsigned char>(in[at++]);
    const std::size_t count = code & 0x7Fu;
    const std::size_t needed = (code & 0x80u) != 0 ? count : std::min<std::size_t>(count, 1);
    has_end = count == 0;
    if (count > out.size() - done || needed > in.size() - at) return false;
    if (needed == count)
      std::memcpy(out.data() + done, in.data() + at, count);
    else
      std::memset(out.data() + done, static_cast<unsigned char>(in[at]), count);
    at += needed;
    done += count;
  }
  if (done > 0 && done + 1 == out.size() && has_end) out[done] = out[done - 1], ++done;
  return done == out.size() && at == in.size();
}

/// A plane of n bytes needs at least two bytes for each 127 of them.
void require_length(const Scanner& scanner, std::uint64_t bytes, const std::string& path) {
  if (bytes / 64 > scanner.left()) fail_file(path, "it is too short for its dimensions");
}

}  // namespace

FileContents read_slc(const std::string& path) {
  Scanner scanner(path);
  if (scanner.count() != 11111) fail_file(path, "it does not begin with 11111");
  std::array<std::uint64_t, 3> points{};
  for (std::uint64_t& count : points) count = scanner.count();
  if (const std::uint64_t bits = scanner.count(); bits != 8)
    throw Error(ErrorCode::kUnsupported, "'" + path + "' has values of " + std::to_string(bits) + " bits, not of 8");
  VolumeFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) frame.steps[axis][axis] = scanner.number<double>();
  for (int i = 0; i < 3; ++i) scanner.number<std::int64_t>();  // Unit, origin and modification of the data.
  const std::uint64_t compression = scanner.count();
  if (compression > 1) fail_file(path, "its compression is unknown");
  const std::uint64_t width = scanner.count(), height = scanner.count();
  scanner.mark();
  for (int channel = 0; channel < 3; ++channel)
    scanner.bytes(count_bytes(std::array{width, height}, ScalarType::kUint8, path));
  require_length(scanner, count_bytes(points, ScalarType::kUint8, path), path);
  const auto image = make_image(points, 1, ScalarType::kUint8, "SLCImage", path);
  throw_if_vtk_failed(path);
  const std::span<std::byte> values = image_bytes(*image);
  const auto plane = static_cast<std::size_t>(points[0] * points[1]);
  for (std::uint64_t k = 0; k < points[2]; ++k) {
    const std::span<std::byte> slice = values.subspan(static_cast<std::size_t>(k) * plane, plane);
    if (compression == 0) {
      std::memcpy(slice.data(), scanner.bytes(plane).data(), plane);
      continue;
    }
    const std::uint64_t size = scanner.count();
    scanner.mark();
    if (!decode_runs(scanner.bytes(size), slice))
      fail_file(path, "slice " + std::to_string(k) + " does not hold " + std::to_string(plane) + " values");
  }
  FileContents contents;
  set_frame(*image, frame, contents.notes);
  contents.blocks.emplace_back(image);
  return contents;
}

}  // namespace tetravox::io
