/// Any text is either a transfer function that can be drawn with, or an error of the file in one line.

#include "tetravox/error.h"
#include "tetravox/transfer_function.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tetravox;
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (int variant = 0; variant < 8; ++variant) {
    PresetOptions options;
    options.range = {1e-3, 7.0};
    options.logarithmic = variant & 1;
    options.invert = variant & 2;
    TransferFunction function;
    try {
      function = parse_transfer_function(text, "file", variant & 4 ? "a" : "", options, variant & 1);
    } catch (const Error& error) {
      const std::string message = error.what();
      if (error.code() != ErrorCode::kBadFile || message.find('\n') != std::string::npos) std::abort();
      continue;
    }
    // What was read must be valid; only the file's own unit distance may be too small to divide by.
    OpticalFunction optical;
    try {
      optical = make_optical_function(function, 1.0);
    } catch (const Error& error) {
      if (std::string(error.what()).find("unit_distance") == std::string::npos) std::abort();
      continue;
    }
    for (std::size_t i = 0; i < optical.points.size(); ++i) {
      const OpticalPoint& point = optical.points[i];
      if (!std::isfinite(point.value) || !std::isfinite(point.extinction) || point.extinction < 0.0) std::abort();
      if (i > 0 && point.value < optical.points[i - 1].value) std::abort();
      if (!std::isfinite(eval_optical_function(optical, point.value).extinction)) std::abort();
    }
  }
  return 0;
}
