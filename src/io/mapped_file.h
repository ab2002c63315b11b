#pragma once

/// Files as memory: nothing is read before it is looked at, and nothing is copied.

#include <cstddef>
#include <memory>
#include <span>

namespace tetravox::io {

/// The bytes of a file, mapped for reading as long as this object lives. Looking at them is safe even when another
/// program makes the file shorter: what it cuts off reads as zeros from then on.
class MappedFile {
 public:
  /// Maps the first `size` bytes of an open file, which may be closed then; null where the system will not.
  static std::shared_ptr<const MappedFile> map(int descriptor, std::size_t size);

  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return bytes_; }
  /// Whether bytes were found missing.
  bool was_cut_short() const;
  /// Tells the system that all bytes will be passed over in order, or that nothing is known of that.
  void expect_one_pass(bool is_one_pass) const;

 private:
  MappedFile(std::span<const std::byte> bytes, std::size_t guard) : bytes_(bytes), guard_(guard) {}

  std::span<const std::byte> bytes_;
  std::size_t guard_ = 0;
};

}  // namespace tetravox::io
