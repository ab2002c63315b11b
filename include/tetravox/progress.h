#pragma once

/// How long work tells how far it is, and how it is told to stop.

#include <atomic>
#include <functional>
#include <string_view>

namespace tetravox {

/// Passed to every long operation. Both members may be left empty.
struct Progress {
  /// Called now and then, from one thread at a time, with the step ("read", "prepare", "draw") and the part done in [0,
  /// 1].
  std::function<void(std::string_view step, double fraction)> report;
  /// When it becomes true the operation throws `Error` with `ErrorCode::kCancelled` as soon as it can.
  const std::atomic<bool>* cancelled = nullptr;
};

}  // namespace tetravox
