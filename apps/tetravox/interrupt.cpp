#include "apps/tetravox/interrupt.h"

#include <csignal>

namespace tetravox::tool {
namespace {

// A signal handler can reach only what has static storage.
std::atomic<bool> g_interrupted{false};
std::atomic<int> g_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void set_handler(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

void on_signal(int signal) {
  g_signal.store(signal);
  g_interrupted.store(true);
  set_handler(SIG_DFL);
}

}  // namespace

void install_interrupt_handlers() { set_handler(on_signal); }

const std::atomic<bool>& interrupt_flag() { return g_interrupted; }

int interrupt_signal() { return g_signal.load(); }

}  // namespace tetravox::tool
