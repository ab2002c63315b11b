#pragma once

/// Ctrl-C: the first SIGINT or SIGTERM asks the work to stop, the second ends the process at once.

#include <atomic>

namespace tetravox::tool {

void install_interrupt_handlers();

/// Becomes true with the first signal; for `Progress::cancelled`.
const std::atomic<bool>& interrupt_flag();

/// Number of the signal that came, 0 without one.
int interrupt_signal();

}  // namespace tetravox::tool
