#pragma once

/// One line on the terminal that tells how far long work is.

#include "tetravox/progress.h"

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace tetravox::tool {

/// Shows "reading 45 %" on stderr when that is a terminal and the work has taken half a second; gone when it ends.
class ProgressLine {
 public:
  explicit ProgressLine(bool use_terminal);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// What is handed to long operations: this line and the interrupt flag. Must not outlive the line.
  Progress progress();
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void show(std::string_view step, double fraction);

  bool is_terminal_ = false;
  bool is_shown_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_{};
  std::mutex mutex_;
};

/// @throws Error (kCancelled) once a signal has come.
void throw_if_interrupted();

}  // namespace tetravox::tool
