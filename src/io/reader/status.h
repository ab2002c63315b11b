#pragma once

/// Messages to the parent, and everything that VTK complains about.

#include "tetravox/error.h"

#include <cstdint>
#include <exception>
#include <string>

namespace tetravox::io {

/// Writes one line to the status pipe. Allocates nothing, so that it works when memory has run out.
void send_error(ErrorCode code, const char* text) noexcept;
/// The error for an exception of a library, about the file that `install_error_handlers` was told.
void send_exception(const std::exception& exception) noexcept;
void send_progress(double fraction) noexcept;
void send_done() noexcept;

/// From now on VTK's errors and warnings are kept instead of printed, and every way in which C++ gives up (no memory,
/// an exception that nobody catches) ends in a message about `file`.
void install_error_handlers(const std::string& file, std::uint64_t memory_limit);

/// @throws Error (kBadFile, or kOutOfMemory where that was the cause) with VTK's first complaint, if there is one.
void throw_if_vtk_failed(const std::string& file);

/// VTK's first warning since the start, cleaned; empty where there is none.
std::string first_vtk_warning();

/// The message for a file that needs more memory than `memory_limit`.
std::string describe_out_of_memory(const std::string& file, std::uint64_t memory_limit);

}  // namespace tetravox::io
