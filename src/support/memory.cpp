#include "src/support/memory.h"

#include "tetravox/error.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

namespace tetravox::support {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

std::uint64_t read_number(const char* path) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  return file >> value ? value : kUnlimited;  // "max" does not parse: unlimited
}

std::uint64_t left_of(const char* limit_path, const char* usage_path) {
  const std::uint64_t limit = read_number(limit_path);
  const std::uint64_t usage = read_number(usage_path);
  if (limit == kUnlimited || usage == kUnlimited) return kUnlimited;
  return limit > usage ? limit - usage : 0;
}

std::uint64_t system_memory() {
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  std::uint64_t value = 0;
  while (file >> key >> value) {
    if (key == "MemAvailable:") return value * 1024;
    std::getline(file, unit);
  }
  return kUnlimited;
}

}  // namespace

std::uint64_t available_memory() {
  return std::min(
      {system_memory(), left_of("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
       left_of("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes")});
}

std::uint64_t peak_resident_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void require_memory(std::uint64_t needed, const std::string& purpose) {
  const std::uint64_t available = available_memory();
  if (needed <= available) return;
  throw Error(ErrorCode::kOutOfMemory, purpose + " needs about " + format_bytes(needed) + " of memory and " +
                                           format_bytes(available) +
                                           " are free: close other programs or use a larger machine");
}

std::string format_bytes(std::uint64_t bytes) {
  const char* units[] = {"bytes", "kB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes);
  int unit = 0;
  while (value >= 1024.0 && unit < 4) {
    value /= 1024.0;
    ++unit;
  }
  char text[64];
  std::snprintf(text, sizeof text, unit == 0 || value >= 100.0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

}  // namespace tetravox::support
