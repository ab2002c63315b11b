#include "src/io/reader/status.h"

#include "src/io/reader_protocol.h"
#include "src/support/memory.h"

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>

namespace tetravox::io {

namespace {

void write_all(const char* text, std::size_t size) noexcept {
  while (size > 0) {
    const ssize_t written = write(kStatusDescriptor, text, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text += written;
    size -= static_cast<std::size_t>(written);
  }
}

void send_complaint(const std::string& text) noexcept {
  write_all("complaint ", 10);
  write_all(text.data(), text.size());
  write_all("\n", 1);
}

/// VTK's message without its place in VTK's sources: what follows the class name and address.
std::string strip_vtk_message(const char* text) {
  std::string message = text ? text : "";
  if (const std::size_t line_end = message.find('\n'); line_end != std::string::npos && message.find("In ") < line_end)
    message.erase(0, line_end + 1);
  if (const std::size_t object = message.find("): "); object != std::string::npos && object < 120)
    message.erase(0, object + 3);
  return clean_line(message, 300);
}

/// Whether a warning tells of something that could not be read.
bool is_about_failure(const char* text) {
  const std::string message = text ? text : "";
  for (const char* words : {"rror", "ailed", "remature", "ismatch", "annot", "ould not", "nable", "runcated", "orrupt"})
    if (message.find(words) != std::string::npos) return true;
  return false;
}

/// Keeps the first error and the first warning. VTK may complain from any thread.
class ComplaintKeeper : public vtkOutputWindow {
 public:
  static ComplaintKeeper* New();

  void DisplayText(const char*) override {}
  void DisplayDebugText(const char*) override {}
  void DisplayErrorText(const char* text) override { keep(error_, text); }
  void DisplayWarningText(const char* text) override { keep(is_about_failure(text) ? error_ : warning_, text); }
  void DisplayGenericWarningText(const char* text) override { DisplayWarningText(text); }

  std::string error() const {
    const std::lock_guard lock(mutex_);
    return error_;
  }
  std::string warning() const {
    const std::lock_guard lock(mutex_);
    return warning_;
  }

 private:
  void keep(std::string& kept, const char* text) {
    const std::lock_guard lock(mutex_);
    if (!kept.empty()) return;
    kept = strip_vtk_message(text);
    if (kept.empty()) kept = "VTK gives no reason";
    send_complaint(kept);  // The parent will want it should this process crash.
  }
  mutable std::mutex mutex_;
  std::string error_, warning_;
};
vtkStandardNewMacro(ComplaintKeeper)

    ComplaintKeeper& complaints() {
  static const vtkNew<ComplaintKeeper> keeper;
  return *keeper;
}

/// Made ready while there still is memory.
std::string& out_of_memory_message() {
  static std::string message;
  return message;
}

/// Begins messages about exceptions.
std::string& exception_message() {
  static std::string message;
  return message;
}

[[noreturn]] void leave_without_memory() {
  send_error(ErrorCode::kOutOfMemory, out_of_memory_message().c_str());
  _exit(1);
}

[[noreturn]] void leave_with_exception() {
  try {
    if (const std::exception_ptr exception = std::current_exception()) std::rethrow_exception(exception);
  } catch (const std::bad_alloc&) {
    leave_without_memory();
  } catch (const std::exception& exception) {
    send_exception(exception);
    _exit(1);
  } catch (...) {
  }
  std::abort();
}

bool is_about_memory(const std::string& message) {
  for (const char* words : {"nable to allocate", "bad_alloc", "out of memory", "llocation failed", "annot allocate"})
    if (message.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace

void send_error(ErrorCode code, const char* text) noexcept {
  char line[kLongestMessage + 32];
  const int size = std::snprintf(line, sizeof line - 1, "error %d ", static_cast<int>(code));
  std::size_t length = static_cast<std::size_t>(size);
  for (; *text && length < kLongestMessage; ++text) line[length++] = *text == '\n' ? ' ' : *text;
  line[length++] = '\n';
  write_all(line, length);
}

void send_exception(const std::exception& exception) noexcept {
  char text[512];
  std::snprintf(text, sizeof text, "%s (%.100s): the file is damaged or not what its ending says",
                exception_message().c_str(), exception.what());
  send_error(ErrorCode::kBadFile, text);
}

void send_progress(double fraction) noexcept {
  char line[64];
  const int size = std::snprintf(line, sizeof line, "progress %.3f\n", fraction);
  write_all(line, static_cast<std::size_t>(size));
}

void send_done() noexcept { write_all("done\n", 5); }

void install_error_handlers(const std::string& file, std::uint64_t memory_limit) {
  const std::size_t begin = file.size() - std::min<std::size_t>(file.size(), 300);
  exception_message() = std::string("'").append(file, begin).append("' has counts or sizes that make no sense");
  out_of_memory_message() = describe_out_of_memory(file, memory_limit);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  vtkOutputWindow::SetInstance(&complaints());
  std::set_new_handler(leave_without_memory);
  std::set_terminate(leave_with_exception);
}

void throw_if_vtk_failed(const std::string& file) {
  const std::string error = complaints().error();
  if (error.empty()) return;
  if (is_about_memory(error)) throw Error(ErrorCode::kOutOfMemory, out_of_memory_message());
  throw Error(ErrorCode::kBadFile,
              "'" + file + "' could not be read: " + error + "; the file is damaged or not what its ending says");
}

std::string first_vtk_warning() { return complaints().warning(); }

std::string describe_out_of_memory(const std::string& file, std::uint64_t memory_limit) {
  return "reading '" + file + "' takes more than the " + support::format_bytes(memory_limit) +
         " there are: free memory, use a smaller file, or its counts are damaged";
}

}  // namespace tetravox::io
