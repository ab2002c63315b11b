#include "src/io/reader/volume_stream.h"

#include "src/io/reader/blocks.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace tetravox::io {

namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
/// Deflate makes at most 1032 bytes of one; a promise of more is a lie.
constexpr std::uint64_t kMostInflation = 1040;
/// So much is inflated behind the volume to find the end of the stream and its checksum.
constexpr std::uint64_t kMostDrained = std::uint64_t{64} << 20;

/// A file open for reading.
class InputFile {
 public:
  explicit InputFile(const std::string& path)
      : path_(path), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status {};
    if (descriptor_ < 0 || fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
      if (descriptor_ >= 0) close(descriptor_);
      throw Error(ErrorCode::kBadFile, "the data file '" + path + "' is missing or cannot be opened");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() { close(descriptor_); }

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Bytes read at `offset`; fewer than `count` at the file's end only.
  std::size_t read_at(std::uint64_t offset, std::byte* out, std::size_t count) const {
    std::size_t done = 0;
    while (done < count) {
      const ssize_t got = pread(descriptor_, out + done, count - done, static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail_file(path_, "it could not be read");
      if (got == 0) break;
      done += static_cast<std::size_t>(got);
    }
    return done;
  }

 private:
  std::string path_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

/// Inflates a zlib or gzip stream. gzip files may consist of several.
class Inflater {
 public:
  Inflater(const InputFile& file, std::uint64_t offset) : file_(file), at_(offset), buffer_(kBufferBytes) {
    if (inflateInit2(&stream_, MAX_WBITS + 32) != Z_OK) throw std::bad_alloc();
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  /// Inflates until `count` bytes are there, or the stream ends; returns how many there are.
  std::size_t inflate_some(std::byte* out, std::size_t count) {
    std::size_t done = 0;
    while (done < count && !has_ended_) {
      stream_.next_out = reinterpret_cast<Bytef*>(out + done);
      stream_.avail_out = static_cast<uInt>(std::min<std::size_t>(count - done, std::size_t{1} << 30));
      const std::size_t room = stream_.avail_out;
      fill();
      const int result = inflate(&stream_, Z_NO_FLUSH);
      done += room - stream_.avail_out;
      if (result == Z_STREAM_END)
        begin_next_member();
      else if (result != Z_OK && result != Z_BUF_ERROR)
        fail_file(file_.path(), "its compressed data are damaged");
    }
    return done;
  }

 private:
  void fill() {
    if (stream_.avail_in > 0) return;
    const std::size_t got = file_.read_at(at_, buffer_.data(), buffer_.size());
    if (got == 0) fail_file(file_.path(), "its compressed data end too early");
    at_ += got;
    stream_.next_in = reinterpret_cast<Bytef*>(buffer_.data());
    stream_.avail_in = static_cast<uInt>(got);
  }
  /// Goes on with the next member of a gzip file, if there is one; anything else behind the stream is not ours.
  void begin_next_member() {
    has_ended_ = true;
    std::array<std::byte, 2> next{};
    const std::uint64_t begin = at_ - stream_.avail_in;
    if (file_.read_at(begin, next.data(), 2) < 2 || next[0] != std::byte{0x1F} || next[1] != std::byte{0x8B}) return;
    has_ended_ = inflateReset(&stream_) != Z_OK;
  }

  const InputFile& file_;
  std::uint64_t at_;
  std::vector<std::byte> buffer_;
  z_stream stream_{};
  bool has_ended_ = false;
};

}  // namespace

/// Bytes of one file.
class VolumeStream::Source {
 public:
  virtual ~Source() = default;
  virtual void read(std::span<std::byte> out) = 0;
  virtual void skip(std::uint64_t bytes) = 0;
  /// Called when the part of the volume has been read: bytes that follow.
  virtual std::uint64_t finish() = 0;
};

class VolumeStream::PlainSource : public Source {
 public:
  PlainSource(const std::string& path, std::uint64_t offset, bool is_at_end, std::uint64_t bytes)
      : file_(path), at_(offset) {
    const std::uint64_t begin = is_at_end ? 0 : offset;
    if (begin > file_.size() || bytes > file_.size() - begin)
      fail_file(path, "it is " + std::to_string(file_.size()) + " bytes long and should hold " + std::to_string(bytes) +
                          (begin > 0 ? " after the first " + std::to_string(begin) : ""));
    if (is_at_end) at_ = file_.size() - bytes;
  }
  void read(std::span<std::byte> out) override {
    if (file_.read_at(at_, out.data(), out.size()) < out.size()) fail_file(file_.path(), "it ends too early");
    at_ += out.size();
  }
  void skip(std::uint64_t bytes) override { at_ += bytes; }
  std::uint64_t finish() override { return file_.size() - std::min(at_, file_.size()); }

 private:
  InputFile file_;
  std::uint64_t at_;
};

class VolumeStream::InflatingSource : public Source {
 public:
  InflatingSource(const std::string& path, std::uint64_t offset, std::uint64_t bytes)
      : file_(path), inflater_(file_, offset) {
    if (offset > file_.size() || bytes / kMostInflation > file_.size() - offset)
      fail_file(path, "its compressed data are too short for the " + std::to_string(bytes) + " bytes they should hold");
  }
  void read(std::span<std::byte> out) override {
    const std::size_t got = inflater_.inflate_some(out.data(), out.size());
    if (got < out.size()) fail_file(file_.path(), "its compressed data hold fewer values than they should");
  }
  void skip(std::uint64_t bytes) override {
    std::vector<std::byte> scratch(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, kBufferBytes)));
    for (; bytes > 0; bytes -= std::min<std::uint64_t>(bytes, scratch.size()))
      read(std::span(scratch).first(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, scratch.size()))));
  }
  std::uint64_t finish() override {
    std::vector<std::byte> scratch(kBufferBytes);
    std::uint64_t rest = 0;
    while (rest < kMostDrained) {
      const std::size_t got = inflater_.inflate_some(scratch.data(), scratch.size());
      rest += got;
      if (got < scratch.size()) break;
    }
    return rest;
  }

 private:
  InputFile file_;
  Inflater inflater_;
};

VolumeStream::VolumeStream(VolumeFiles files, std::uint64_t bytes) : files_(std::move(files)) {
  const std::size_t count = files_.paths.size();
  if (count == 0) throw Error(ErrorCode::kBadFile, "no data file is named");
  if (bytes % count != 0)
    fail_file(files_.paths.front(), "the volume's " + std::to_string(bytes) + " bytes cannot be spread evenly over " +
                                        std::to_string(count) + " files");
  bytes_per_file_ = bytes / count;
  open_next();
}

VolumeStream::~VolumeStream() = default;

void VolumeStream::open_next() {
  if (source_) source_->finish();
  const std::string& path = files_.paths.at(next_++);
  left_ = bytes_per_file_;
  if (files_.is_compressed) {
    source_ = std::make_unique<InflatingSource>(path, files_.offset, bytes_per_file_);
    source_->skip(files_.inflated_skip);
  } else {
    source_ = std::make_unique<PlainSource>(path, files_.offset, files_.is_at_end, bytes_per_file_);
  }
}

void VolumeStream::read(std::span<std::byte> out) {
  while (!out.empty()) {
    if (left_ == 0) open_next();
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, out.size()));
    source_->read(out.first(count));
    out = out.subspan(count);
    left_ -= count;
  }
}

void VolumeStream::skip(std::uint64_t bytes) {
  while (bytes > 0) {
    if (left_ == 0) open_next();
    const std::uint64_t count = std::min(left_, bytes);
    source_->skip(count);
    bytes -= count;
    left_ -= count;
  }
}

std::uint64_t VolumeStream::count_rest() {
  const bool is_whole = left_ == 0 && next_ == files_.paths.size();
  return is_whole && !files_.is_at_end ? source_->finish() : 0;
}

std::string read_head(const std::string& path, std::size_t count) {
  const InputFile file(path);
  std::string head(count, '\0');
  auto* out = reinterpret_cast<std::byte*>(head.data());
  head.resize(is_gzip(path) ? Inflater(file, 0).inflate_some(out, count) : file.read_at(0, out, count));
  return head;
}

bool is_gzip(const std::string& path) {
  const InputFile file(path);
  std::array<std::byte, 2> head{};
  return file.read_at(0, head.data(), 2) == 2 && head[0] == std::byte{0x1F} && head[1] == std::byte{0x8B};
}

std::uint64_t file_size(const std::string& path) { return InputFile(path).size(); }

}  // namespace tetravox::io
