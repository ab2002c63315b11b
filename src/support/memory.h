#pragma once

/// How much memory there is, and how much this process took.

#include <cstdint>
#include <string>

namespace tetravox::support {

/// Bytes that this process may still allocate without pushing the machine into swapping or the OOM killer:
/// the least of MemAvailable and what the control groups (v1 and v2) leave.
std::uint64_t available_memory();

/// Largest resident set so far, bytes.
std::uint64_t peak_resident_memory();

/// @throws Error (kOutOfMemory) in one line when `needed` exceeds `available_memory()`: says what for and how much of
/// each.
void require_memory(std::uint64_t needed, const std::string& purpose);

/// "1.5 GiB", "312 MiB", "17 kB": for people.
std::string format_bytes(std::uint64_t bytes);

}  // namespace tetravox::support
