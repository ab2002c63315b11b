#pragma once

/// The one way in which tetravox reports failure.
///
/// Every public function validates what it is given and throws `tetravox::Error`: a code for programs and a
/// one-line message for people, that names what is wrong, where, and what to do about it. Contracts inside the
/// library are `TETRAVOX_CHECK` (src/support/check.h); kernels are `noexcept`.

#include <stdexcept>
#include <string>

namespace tetravox {

enum class ErrorCode {
  kInvalidArgument,  ///< an option, a key or a value that makes no sense
  kFileNotFound,     ///< no such file, or it cannot be opened
  kBadFile,          ///< a file that is truncated, contradicts itself, or is not what its name says
  kUnsupported,      ///< understood, but not something tetravox draws
  kNothingToDraw,    ///< a valid file without a single cell to draw
  kOutOfMemory,      ///< the estimate of the memory needed exceeds what is there
  kReaderFailed,     ///< the reader process crashed
  kTimeout,          ///< the reader process took longer than it may
  kCannotWrite,      ///< an output could not be written
  kCancelled,        ///< the user interrupted
  kInternal          ///< a broken contract: a bug of tetravox
};

/// An error with a code and a one-line message. Copyable, safe to pass between threads.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace tetravox
