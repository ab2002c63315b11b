#include "apps/tetravox/progress_line.h"

#include "apps/tetravox/interrupt.h"
#include "apps/tetravox/text.h"

#include "tetravox/error.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace tetravox::tool {
namespace {

constexpr std::chrono::milliseconds kPatience{500};
constexpr std::chrono::milliseconds kInterval{100};

std::string describe(std::string_view step) {
  if (step == "read") return "reading";
  if (step == "prepare") return "preparing";
  if (step == "draw") return "drawing";
  return single_line(std::string(step));
}

}  // namespace

ProgressLine::ProgressLine(bool use_terminal) : is_terminal_(use_terminal && ::isatty(STDERR_FILENO) == 1) {}

Progress ProgressLine::progress() {
  Progress progress;
  if (is_terminal_) progress.report = [this](std::string_view step, double fraction) { show(step, fraction); };
  progress.cancelled = &interrupt_flag();
  return progress;
}

void ProgressLine::show(std::string_view step, double fraction) {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  if (now - begin_ < kPatience || now - last_ < kInterval) return;
  last_ = now;
  is_shown_ = true;
  const double percent = std::isfinite(fraction) ? std::clamp(std::floor(100.0 * fraction), 0.0, 100.0) : 0.0;
  std::fprintf(stderr, "\r\033[Ktetravox: %s %.0f %%", describe(step).c_str(), percent);
  std::fflush(stderr);
}

void ProgressLine::clear() {
  const std::lock_guard lock(mutex_);
  if (!is_shown_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  is_shown_ = false;
}

void throw_if_interrupted() {
  if (interrupt_flag().load()) throw Error(ErrorCode::kCancelled, "interrupted");
}

}  // namespace tetravox::tool
