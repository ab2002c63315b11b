#pragma once

/// Runs `tetravox` as a child process in a directory of its own.

#include <gtest/gtest.h>
#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace tetravox::cli {

/// What a run left: exit code (128 + signal for a process that a signal ended) and everything it printed.
struct Result {
  int code = -1;
  std::string out;
  std::string err;
};

/// A process that still runs.
struct Running {
  pid_t pid = -1;
  std::filesystem::path out, err;
};

/// A new directory for each test; tools run in it.
class ToolTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  Result run(const std::vector<std::string>& arguments) const;
  /// The process leads a group of its own, as a job of a shell does.
  Running start(const std::vector<std::string>& arguments) const;
  /// Waits at most `seconds`, then kills the process and fails the test.
  Result finish(const Running& running, double seconds = 50.0) const;

  std::filesystem::path path(const std::string& name) const { return directory_ / name; }
  std::string read(const std::string& name) const;
  void write(const std::string& name, const std::string& text) const;
  /// Names in the directory, sorted; without the files that catch output.
  std::vector<std::string> names() const;
  /// A small legacy VTK file: one tetrahedron with the point array "ramp" (0 to 3) and the constant array "same".
  void write_tetrahedron(const std::string& name) const;

  std::filesystem::path directory_;
};

/// Expects one line on stderr that begins with "tetravox: " and holds all of `parts`, and this exit code.
void expect_error(const Result& result, int code, const std::vector<std::string>& parts);

/// Processes whose parent is `pid`.
std::vector<pid_t> children_of(pid_t pid);

}  // namespace tetravox::cli
