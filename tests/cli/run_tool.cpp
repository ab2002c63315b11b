#include "tests/cli/run_tool.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

namespace tetravox::cli {
namespace {

namespace fs = std::filesystem;

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

void ToolTest::SetUp() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  directory_ = fs::path(testing::TempDir()) / ("tetravox_cli_" + std::string(info->test_suite_name()) + "_" +
                                               info->name() + "_" + std::to_string(::getpid()));
  fs::create_directories(directory_);
}

void ToolTest::TearDown() {
  std::error_code ignored;
  fs::remove_all(directory_, ignored);
}

Running ToolTest::start(const std::vector<std::string>& arguments) const {
  static int counter = 0;
  Running running;
  running.out = directory_ / (".out" + std::to_string(++counter));
  running.err = directory_ / (".err" + std::to_string(counter));
  std::vector<char*> argv{const_cast<char*>(TETRAVOX_TOOL)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  running.pid = ::fork();
  if (running.pid == 0) {
    ::setpgid(0, 0);
    const int out = ::open(running.out.c_str(), O_CREAT | O_WRONLY, 0600);
    const int err = ::open(running.err.c_str(), O_CREAT | O_WRONLY, 0600);
    if (out < 0 || err < 0 || ::chdir(directory_.c_str()) != 0) ::_exit(99);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    ::execv(TETRAVOX_TOOL, argv.data());
    ::_exit(98);
  }
  ::setpgid(running.pid, running.pid);
  return running;
}

Result ToolTest::finish(const Running& running, double seconds) const {
  Result result;
  int status = 0;
  const auto begin = std::chrono::steady_clock::now();
  while (::waitpid(running.pid, &status, WNOHANG) == 0) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > seconds) {
      ADD_FAILURE() << "the tool did not end within " << seconds << " s";
      ::kill(running.pid, SIGKILL);
      ::waitpid(running.pid, &status, 0);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_all(running.out);
  result.err = read_all(running.err);
  return result;
}

Result ToolTest::run(const std::vector<std::string>& arguments) const { return finish(start(arguments)); }

std::string ToolTest::read(const std::string& name) const { return read_all(path(name)); }

void ToolTest::write(const std::string& name, const std::string& text) const {
  fs::create_directories(path(name).parent_path());
  std::ofstream(path(name), std::ios::binary) << text;
}

std::vector<std::string> ToolTest::names() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(".out") && !name.starts_with(".err")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void ToolTest::write_tetrahedron(const std::string& name) const {
  write(name,
        "# vtk DataFile Version 3.0\ntetrahedron\nASCII\nDATASET UNSTRUCTURED_GRID\n"
        "POINTS 4 float\n0 0 0  1 0 0  0 1 0  0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
        "POINT_DATA 4\nSCALARS ramp float 1\nLOOKUP_TABLE default\n0 1 2 3\n"
        "SCALARS same float 1\nLOOKUP_TABLE default\n5 5 5 5\n");
}

void expect_error(const Result& result, int code, const std::vector<std::string>& parts) {
  EXPECT_EQ(result.code, code) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(result.err.starts_with("tetravox: ")) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  for (const std::string& part : parts)
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " in " << result.err;
}

std::vector<pid_t> children_of(pid_t pid) {
  std::vector<pid_t> children;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    // "pid (command) state parent ...": the command may hold anything, so look behind its last bracket.
    const std::string status = read_all(entry.path() / "stat");
    const std::size_t bracket = status.rfind(')');
    if (bracket == std::string::npos) continue;
    std::istringstream rest(status.substr(bracket + 1));
    char state = 0;
    pid_t parent = 0;
    if (rest >> state >> parent && parent == pid) children.push_back(static_cast<pid_t>(std::stol(name)));
  }
  return children;
}

}  // namespace tetravox::cli
