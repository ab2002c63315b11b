#pragma once

/// Runs the reader process to its end, whatever it does.

#include "src/io/reader_protocol.h"
#include "tetravox/progress.h"

#include <memory>
#include <span>

namespace tetravox::io {

/// The memory file of a reader that ended well, sealed and mapped for reading.
struct SharedMemory {
  std::shared_ptr<const void> storage;
  std::span<const std::byte> bytes;
};

/// Starts `tetravox-reader`, forwards its progress, ends it on time-out, on cancellation and when it leaves, and maps
/// what it made. Nothing in there is checked yet except the header's magic number and the total size.
/// @throws Error: what the reader reports; kReaderFailed when it cannot be found or crashes; kTimeout; kCancelled.
SharedMemory run_reader(const ReaderRequest& request, const Progress& progress);

/// Path of the `tetravox-reader` to use: the environment variable TETRAVOX_READER, or beside the program or library, in
/// ../libexec/tetravox or ../lib/tetravox from there, or where tetravox was installed.
/// @throws Error (kReaderFailed) that says where it was looked for.
std::string find_reader();

}  // namespace tetravox::io
