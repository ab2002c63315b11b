#include "src/io/mapped_file.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

namespace tetravox::io {

namespace {

/// A mapped range, as the signal handler sees it. Free where `end` is 0.
struct Guard {
  std::atomic<std::uintptr_t> begin{0}, end{0};
  std::atomic<bool> was_cut_short{false};
};
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

// A signal handler can look at nothing else.
std::array<Guard, 64> guards;
std::mutex guards_mutex;
struct sigaction previous_action {};
std::uintptr_t page_size = 4096;

/// Zeros in place of everything from the page of `address` to the end of its range: as the file ends before it, the
/// rest is missing too. False for an address that we did not map.
bool replace_missing_pages(std::uintptr_t address) {
  for (Guard& guard : guards) {
    const std::uintptr_t begin = guard.begin, end = guard.end;
    if (address < begin || address >= end) continue;
    const std::uintptr_t first = address / page_size * page_size;
    guard.was_cut_short = true;
    return mmap(reinterpret_cast<void*>(first), end - first, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1,
                0) != MAP_FAILED;
  }
  return false;
}

/// SIGBUS: a page that is mapped and lies behind the end of its file was looked at.
void handle_missing_page(int signal_number, siginfo_t* info, void* context) {
  const bool is_fault = info->si_code > 0;  // Otherwise a process sent it.
  if (is_fault && replace_missing_pages(reinterpret_cast<std::uintptr_t>(info->si_addr))) return;
  // Not ours: whoever was there before us decides.
  if (previous_action.sa_flags & SA_SIGINFO) return previous_action.sa_sigaction(signal_number, info, context);
  if (previous_action.sa_handler == SIG_IGN && !is_fault) return;
  if (previous_action.sa_handler != SIG_DFL && previous_action.sa_handler != SIG_IGN)
    return previous_action.sa_handler(signal_number);
  sigaction(SIGBUS, &previous_action, nullptr);
  raise(signal_number);  // Comes once this handler has returned.
}

void install_handler() {
  static std::once_flag once;
  std::call_once(once, [] {
    page_size = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    struct sigaction action {};
    action.sa_sigaction = handle_missing_page;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    sigemptyset(&action.sa_mask);
    sigaction(SIGBUS, &action, &previous_action);
  });
}

}  // namespace

std::shared_ptr<const MappedFile> MappedFile::map(int descriptor, std::size_t size) {
  install_handler();
  const std::lock_guard lock(guards_mutex);
  std::size_t free = 0;
  while (free < guards.size() && guards[free].end != 0) ++free;
  if (free == guards.size()) return nullptr;
  void* address = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (address == MAP_FAILED) return nullptr;
  const auto begin = reinterpret_cast<std::uintptr_t>(address);
  guards[free].was_cut_short = false;
  guards[free].begin = begin;
  guards[free].end = begin + size;
  return std::shared_ptr<const MappedFile>(new MappedFile({static_cast<const std::byte*>(address), size}, free));
}

MappedFile::~MappedFile() {
  const std::lock_guard lock(guards_mutex);
  // In this order: the address may belong to somebody else right after it is given back.
  guards[guard_].end = 0;
  munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

bool MappedFile::was_cut_short() const { return guards[guard_].was_cut_short; }

void MappedFile::expect_one_pass(bool is_one_pass) const {
  madvise(const_cast<std::byte*>(bytes_.data()), bytes_.size(), is_one_pass ? MADV_SEQUENTIAL : MADV_NORMAL);
}

}  // namespace tetravox::io
