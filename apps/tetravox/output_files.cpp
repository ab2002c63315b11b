#include "apps/tetravox/output_files.h"

#include "tetravox/error.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace tetravox::tool {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw Error(ErrorCode::kCannotWrite, "cannot write '" + path + "': " + reason);
}

}  // namespace

void require_writable(const std::string& path) {
  std::error_code ignored;
  // A symbolic link is followed when the file is written.
  const fs::path target = fs::is_symlink(path, ignored) ? fs::weakly_canonical(path, ignored) : fs::path(path);
  const fs::path parent = target.parent_path().empty() ? fs::path(".") : target.parent_path();
  if (!fs::is_directory(parent, ignored))
    fail(path, "there is no directory '" + parent.string() + "'; make the directory first");
  if (fs::is_directory(target, ignored)) fail(path, "it is a directory; name a file in it");
  const bool is_there = fs::exists(target, ignored);
  if (is_there && !fs::is_regular_file(target, ignored)) fail(path, "it is not a regular file");
  if (::access(parent.c_str(), W_OK) != 0 || (is_there && ::access(target.c_str(), W_OK) != 0))
    fail(path, std::generic_category().message(errno) + "; choose a place that you may write to");
}

bool OutputFiles::exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const std::string& path : written_) fs::remove(path, ignored);
}

}  // namespace tetravox::tool
