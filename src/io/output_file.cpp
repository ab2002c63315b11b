#include "src/io/output_file.h"

#include "tetravox/error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace tetravox::io {
namespace {

/// What a user can do about a failure to write.
std::string advice(int error) {
  switch (error) {
    case ENOENT:
      return "; make the directory first, or choose another name";
    case ENOTDIR:
      return "; a part of the path is a file";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; choose a place that you may write to";
    case EISDIR:
      return "; name a file in it";
    case ENOSPC:
    case EDQUOT:
      return "; free some space, or choose another disk";
    default:
      return "";
  }
}

/// True where an open file without a name can be given one later.
bool can_link_unnamed() { return ::access("/proc/self/fd", X_OK) == 0; }

}  // namespace

OutputFile::OutputFile(const std::string& path) : path_(path), target_(path) {
  // Write through a symbolic link instead of replacing it.
  std::error_code ignored;
  if (std::filesystem::is_symlink(path, ignored)) {
    const auto resolved = std::filesystem::weakly_canonical(path, ignored);
    if (!ignored) target_ = resolved.string();
  }
  struct stat status {};
  if (::stat(target_.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) error_ = EISDIR;
    if (!S_ISDIR(status.st_mode) && !S_ISREG(status.st_mode)) error_ = EINVAL;
    if (error_ == 0 && ::access(target_.c_str(), W_OK) != 0) error_ = errno;
    if (error_ != 0) fail();
    permissions_ = static_cast<int>(status.st_mode & 0777u);
  }
  open();
}

OutputFile::~OutputFile() {
  if (file_) std::fclose(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

std::string OutputFile::temporary_name(const std::string& directory) const {
  static std::atomic<unsigned> counter{0};
  return directory + "/.tetravox-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp";
}

void OutputFile::open() {
  const auto parent = std::filesystem::path(target_).parent_path().string();
  directory_ = parent.empty() ? "." : parent;
  int descriptor = -1;
  if (can_link_unnamed()) descriptor = ::open(directory_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  // Some file systems know no files without a name (EOPNOTSUPP, and EISDIR or EINVAL from old ones).
  for (int attempt = 0; descriptor < 0 && attempt < 100; ++attempt) {
    temporary_ = temporary_name(directory_);
    descriptor = ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) break;
  }
  if (descriptor < 0) {
    error_ = errno;
    temporary_.clear();
    fail();
  }
  if (permissions_ >= 0 && ::fchmod(descriptor, static_cast<mode_t>(permissions_)) != 0) errno = 0;
  file_ = ::fdopen(descriptor, "w+b");
  if (!file_) {
    error_ = errno;
    ::close(descriptor);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    fail();
  }
}

bool OutputFile::try_write(const void* bytes, std::size_t count) noexcept {
  if (error_ != 0) return false;
  errno = 0;
  if (std::fwrite(bytes, 1, count, file_) == count) return true;
  error_ = errno != 0 ? errno : EIO;
  return false;
}

void OutputFile::write(const void* bytes, std::size_t count) {
  if (!try_write(bytes, count)) fail();
}

std::size_t OutputFile::tell() {
  const off_t position = ::ftello(file_);
  if (position >= 0) return static_cast<std::size_t>(position);
  error_ = errno;
  fail();
}

void OutputFile::seek(std::size_t position) {
  if (::fseeko(file_, static_cast<off_t>(position), SEEK_SET) == 0) return;
  error_ = errno;
  fail();
}

void OutputFile::commit() {
  if (error_ != 0) fail();
  if (std::fflush(file_) != 0) {
    error_ = errno;
    fail();
  }
  // Give the complete file a temporary name (a link cannot replace an older file), then rename.
  if (temporary_.empty()) {
    const std::string name = temporary_name(directory_);
    const std::string unnamed = "/proc/self/fd/" + std::to_string(::fileno(file_));
    if (::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) {
      error_ = errno;
      fail();
    }
    temporary_ = name;
  }
  std::FILE* file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0 || ::rename(temporary_.c_str(), target_.c_str()) != 0) {
    error_ = errno;
    fail();
  }
  temporary_.clear();
}

void OutputFile::fail() const {
  const std::string reason = error_ == EINVAL ? "it is not a regular file" : std::generic_category().message(error_);
  throw Error(ErrorCode::kCannotWrite, "cannot write '" + path_ + "': " + reason + advice(error_));
}

}  // namespace tetravox::io
