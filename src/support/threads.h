#pragma once

/// Threads: oneTBB, limited to a number of threads for the length of one call.

#include "tetravox/error.h"
#include "tetravox/progress.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <utility>

namespace tetravox::support {

/// Cores that this process may use.
inline int hardware_threads() { return tbb::this_task_arena::max_concurrency(); }

/// Runs `body()` with at most `threads` threads (0: all cores) for everything parallel inside it.
template <class Body>
void with_threads(int threads, Body&& body) {
  if (threads <= 0) {
    body();
    return;
  }
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute(std::forward<Body>(body));
}

/// Calls `body(begin, end)` for chunks of about `grain` indices that cover [0, count).
template <class Body>
void parallel_chunks(std::size_t count, std::size_t grain, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

/// @throws Error (kCancelled) once `progress` is told to stop.
inline void throw_if_cancelled(const Progress& progress) {
  if (progress.cancelled && progress.cancelled->load(std::memory_order_relaxed))
    throw Error(ErrorCode::kCancelled, "interrupted");
}

}  // namespace tetravox::support
