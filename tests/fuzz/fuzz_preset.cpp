/// Any word is either the name of a preset that can be drawn with, or an error in one line.

#include "tetravox/error.h"
#include "tetravox/transfer_function.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tetravox;
  const std::string name(reinterpret_cast<const char*>(data), size);
  PresetOptions options;
  options.range = {0.5, 2.0};
  options.logarithmic = size % 2;
  TransferFunction function;
  try {
    function = make_preset(name, options);
  } catch (const Error& error) {
    const std::string message = error.what();
    if (error.code() != ErrorCode::kInvalidArgument || message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  make_optical_function(function, 1.0);
  return 0;
}
