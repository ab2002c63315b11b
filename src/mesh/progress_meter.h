#pragma once

/// Progress of preparing, told from inside parallel loops.

#include "src/support/threads.h"
#include "tetravox/progress.h"

#include <atomic>
#include <cstdint>
#include <mutex>

namespace tetravox::mesh {

/// Divides [0, 1] into steps; a step tells how much of it is done and stops when the user asks for it.
class ProgressMeter {
 public:
  explicit ProgressMeter(const Progress& progress) : progress_(progress) {}

  /// Starts a step that ends at `end` of the whole and consists of `total` units. Call from one thread.
  /// @throws Error (kCancelled).
  void begin_step(double end, std::uint64_t total) {
    begin_ = end_;
    end_ = end;
    total_ = total;
    done_ = 0;
    advance(0);
  }

  /// Adds finished units. Safe to call from many threads.
  /// @throws Error (kCancelled).
  void advance(std::uint64_t units) {
    support::throw_if_cancelled(progress_);
    const std::uint64_t done = done_.fetch_add(units) + units;
    if (!progress_.report) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return;
    const double part = total_ == 0 ? 0.0 : static_cast<double>(done) / static_cast<double>(total_);
    const double fraction = begin_ + (end_ - begin_) * (part < 1.0 ? part : 1.0);
    if (fraction - told_ < 0.01 && fraction < 1.0) return;
    told_ = fraction;
    progress_.report("prepare", fraction);
  }

 private:
  const Progress& progress_;
  std::mutex mutex_;
  double begin_ = 0.0, end_ = 0.0, told_ = -1.0;
  std::uint64_t total_ = 0;
  std::atomic<std::uint64_t> done_{0};
};

}  // namespace tetravox::mesh
