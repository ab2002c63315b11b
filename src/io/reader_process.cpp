#include "src/io/reader_process.h"

#include "src/support/threads.h"
#include "src/support/timer.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

namespace tetravox::io {

namespace {

constexpr int kPollMilliseconds = 50;
/// No more than this is kept of what the reader's libraries print.
constexpr std::size_t kMostPrinted = 16384;

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  ~Descriptor() { close(); }
  void close() {
    if (value_ >= 0) ::close(std::exchange(value_, -1));
  }
  int get() const { return value_; }

 private:
  int value_ = -1;
};

[[noreturn]] void fail_system(const std::string& what) {
  throw Error(ErrorCode::kReaderFailed, "cannot " + what + " to read a file: " + std::strerror(errno));
}

/// The descriptor under a number that no redirection of the child overwrites.
Descriptor move_high(int descriptor) {
  const Descriptor low(descriptor);
  Descriptor high(fcntl(low.get(), F_DUPFD_CLOEXEC, 16));
  if (high.get() < 0) fail_system("open descriptors");
  return high;
}

std::pair<Descriptor, Descriptor> make_pipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail_system("open a pipe");
  Descriptor read_end(ends[0]), write_end(ends[1]);
  fcntl(read_end.get(), F_SETFL, O_NONBLOCK);
  return {std::move(read_end), move_high(fcntl(write_end.get(), F_DUPFD_CLOEXEC, 16))};
}

/// A child process that does not survive this object.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { kill_and_wait(); }

  void kill_and_wait() {
    if (id_ <= 0) return;
    kill(id_, SIGKILL);
    while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
  }

  /// The status once the child has left. A process that ignores SIGCHLD cannot know: taken as a good end.
  std::optional<int> poll_status() {
    int status = 0;
    const pid_t result = waitpid(id_, &status, WNOHANG);
    if (result == 0 || (result < 0 && errno == EINTR)) return std::nullopt;
    id_ = -1;
    return result < 0 ? 0 : status;
  }

 private:
  pid_t id_;
};

pid_t spawn(const std::string& program, const ReaderRequest& request, int status_fd, int data_fd, int print_fd) {
  std::vector<std::string> texts = format_request(request);
  std::vector<char*> arguments{const_cast<char*>(program.c_str())};
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, print_fd, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, print_fd, STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&actions, status_fd, kStatusDescriptor);
  posix_spawn_file_actions_adddup2(&actions, data_fd, kDataDescriptor);
  // The child starts with plain signals, whatever the embedding program does with its own.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t child = -1;
  const int error = posix_spawn(&child, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw Error(ErrorCode::kReaderFailed, "cannot start '" + program + "' to read a file: " + std::strerror(error));
  return child;
}

/// What the child has said so far.
struct Conversation {
  std::string status;     ///< unfinished line of the status pipe
  std::string printed;    ///< standard output and error
  std::string complaint;  ///< VTK's first
  bool is_done = false;
  std::optional<Error> error;
};

void take_line(std::string_view line, Conversation& conversation, const Progress& progress) {
  if (line == "done") {
    conversation.is_done = true;
  } else if (line.starts_with("progress ")) {
    double fraction = 0.0;
    std::from_chars(line.data() + 9, line.data() + line.size(), fraction);
    if (progress.report) progress.report("read", std::clamp(fraction, 0.0, 1.0));
  } else if (line.starts_with("complaint ") && conversation.complaint.empty()) {
    conversation.complaint = clean_line(std::string(line.substr(10)), 300);
  } else if (line.starts_with("error ") && !conversation.error) {
    int code = 0;
    const auto [end, failure] = std::from_chars(line.data() + 6, line.data() + line.size(), code);
    const std::string text(end, line.data() + line.size());
    if (failure != std::errc() || code < 0 || code > static_cast<int>(ErrorCode::kInternal))
      code = static_cast<int>(ErrorCode::kReaderFailed);
    conversation.error.emplace(static_cast<ErrorCode>(code), clean_line(text));
  }
}

/// Reads what is there; false once the other end is closed.
bool drain(int descriptor, std::string& text, std::size_t most) {
  std::array<char, 4096> buffer;
  for (;;) {
    const ssize_t size = read(descriptor, buffer.data(), buffer.size());
    if (size == 0) return false;
    if (size < 0) return errno == EAGAIN || errno == EINTR;
    if (text.size() < most) text.append(buffer.data(), static_cast<std::size_t>(size));
  }
}

bool drain_status(int descriptor, Conversation& conversation, const Progress& progress) {
  const bool is_open = drain(descriptor, conversation.status, 1 << 20);
  std::size_t begin = 0;
  for (std::size_t end; (end = conversation.status.find('\n', begin)) != std::string::npos; begin = end + 1)
    take_line(std::string_view(conversation.status).substr(begin, end - begin), conversation, progress);
  conversation.status.erase(0, begin);
  return is_open;
}

/// Throws once the user or the clock says so; the child dies with the exception.
void check_limits(const ReaderRequest& request, const support::Timer& timer, const Progress& progress) {
  support::throw_if_cancelled(progress);
  if (timer.seconds() > request.options.timeout)
    throw Error(ErrorCode::kTimeout, "reading '" + request.file + "' took longer than " +
                                         std::to_string(static_cast<long long>(request.options.timeout)) +
                                         " s: allow more time (--reader-timeout), or the file is damaged");
}

/// Listens to the child until it has left; returns its status.
int listen_until_exit(Child& child, int status_fd, int print_fd, const ReaderRequest& request,
                      Conversation& conversation, const Progress& progress) {
  const support::Timer timer;
  bool status_open = true, print_open = true;
  while (status_open || print_open) {
    std::array<pollfd, 2> fds{pollfd{status_open ? status_fd : -1, POLLIN, 0},
                              pollfd{print_open ? print_fd : -1, POLLIN, 0}};
    poll(fds.data(), fds.size(), kPollMilliseconds);
    if (fds[0].revents) status_open = drain_status(status_fd, conversation, progress);
    if (fds[1].revents) print_open = drain(print_fd, conversation.printed, kMostPrinted);
    check_limits(request, timer, progress);
  }
  for (;;) {
    if (const auto status = child.poll_status()) return *status;
    check_limits(request, timer, progress);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

/// The first line that a library printed and that reads like a complaint; empty where there is none.
std::string find_complaint(const std::string& printed) {
  std::size_t begin = 0;
  while (begin < printed.size()) {
    const std::size_t end = std::min(printed.find('\n', begin), printed.size());
    std::string line = printed.substr(begin, end - begin);
    std::string lower = line;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const char* word : {"error", "fail", "corrupt", "truncated", "invalid", "sanitizer"})
      if (lower.find(word) != std::string::npos) return clean_line(line, 300);
    begin = end + 1;
  }
  return {};
}

[[noreturn]] void fail_signal(int signal, const std::string& file, const Conversation& conversation) {
  if (signal == SIGKILL)
    throw Error(ErrorCode::kOutOfMemory, "the reader of '" + file +
                                             "' was killed, most likely for want of memory: free some, or use a "
                                             "smaller file");
  if (!conversation.complaint.empty())
    throw Error(ErrorCode::kBadFile, "'" + file + "' could not be read: " + conversation.complaint +
                                         "; the file is damaged or not what its ending says");
  const std::string complaint = find_complaint(conversation.printed);
  throw Error(ErrorCode::kReaderFailed, "the reader crashed on '" + file + "' (" + strsignal(signal) +
                                            (complaint.empty() ? "" : "; " + complaint) +
                                            "): the file is damaged or not what its ending says; write it again, or in "
                                            "another format such as VTU");
}

/// Throws unless the child ended well and nobody complained.
void check_end(int status, const Conversation& conversation, const std::string& file) {
  if (conversation.error) throw *conversation.error;
  if (WIFSIGNALED(status)) fail_signal(WTERMSIG(status), file, conversation);
  const std::string complaint = find_complaint(conversation.printed);
  if (conversation.is_done && complaint.empty() && WEXITSTATUS(status) == 0) return;
  if (!complaint.empty())
    throw Error(ErrorCode::kBadFile, "'" + file + "' could not be read: " + complaint + "; the file may be damaged");
  throw Error(ErrorCode::kReaderFailed, "the reader of '" + file + "' left without a result (exit code " +
                                            std::to_string(WEXITSTATUS(status)) +
                                            "): check that tetravox and tetravox-reader are of one version");
}

/// Seals the memory file, so that nobody can shrink it any more, and maps it.
SharedMemory map_result(int data_fd, const std::string& file) {
  struct stat status {};
  if (fcntl(data_fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0 || fstat(data_fd, &status) != 0)
    fail_system("seal shared memory");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size < sizeof(SharedHeader))
    throw Error(ErrorCode::kReaderFailed, "the reader of '" + file + "' left no data: please report this");
  void* address = mmap(nullptr, size, PROT_READ, MAP_SHARED, data_fd, 0);
  if (address == MAP_FAILED) fail_system("map shared memory");
  SharedMemory memory;
  memory.storage = std::shared_ptr<const void>(address, [size](const void* p) { munmap(const_cast<void*>(p), size); });
  memory.bytes = {static_cast<const std::byte*>(address), size};
  SharedHeader header;
  std::memcpy(&header, address, sizeof header);
  if (header.magic != kSharedMagic || header.total_bytes != size)
    throw Error(ErrorCode::kReaderFailed, "the reader of '" + file + "' is of another version: install tetravox again");
  return memory;
}

/// Directories in which the running program and the library that holds this function live.
std::vector<std::filesystem::path> home_directories() {
  std::vector<std::filesystem::path> homes;
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) homes.push_back(program.parent_path());
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&find_reader), &library) != 0 && library.dli_fname) {
    const auto path = std::filesystem::canonical(library.dli_fname, error);
    if (!error) homes.push_back(path.parent_path());
  }
  return homes;
}

}  // namespace

std::string find_reader() {
  if (const char* named = std::getenv("TETRAVOX_READER"); named && *named) {
    if (access(named, X_OK) == 0) return named;
    throw Error(ErrorCode::kReaderFailed,
                std::string("TETRAVOX_READER names '") + named + "', which is not a program: correct or unset it");
  }
  std::vector<std::string> candidates;
  for (const auto& home : home_directories())
    for (const char* place : {"", "../libexec/tetravox", "../lib/tetravox", "../../libexec/tetravox"})
      candidates.push_back((home / place / "tetravox-reader").lexically_normal().string());
  candidates.push_back(std::string(TETRAVOX_READER_INSTALL_DIR) + "/tetravox-reader");
  for (const std::string& candidate : candidates)
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
  throw Error(ErrorCode::kReaderFailed, "tetravox-reader, which reads files, is missing: it belongs at '" +
                                            candidates.front() + "' or '" + candidates.back() +
                                            "'; install tetravox again or set TETRAVOX_READER");
}

SharedMemory run_reader(const ReaderRequest& request, const Progress& progress) {
  const std::string program = find_reader();
  const Descriptor data = move_high(memfd_create("tetravox-dataset", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  auto [status_read, status_write] = make_pipe();
  auto [print_read, print_write] = make_pipe();
  Child child(spawn(program, request, status_write.get(), data.get(), print_write.get()));
  status_write.close();
  print_write.close();
  Conversation conversation;
  const int status = listen_until_exit(child, status_read.get(), print_read.get(), request, conversation, progress);
  check_end(status, conversation, request.file);
  return map_result(data.get(), request.file);
}

}  // namespace tetravox::io
